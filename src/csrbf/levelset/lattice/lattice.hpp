#pragma once

#include "csrbf/kernels/kernel.hpp"
#include "csrbf/levelset/lattice/buffer_pool.hpp"

#include <functional>
#include <string>
#include <vector>

namespace csrbf {

struct LatticeOptions {
  double center_spacing = 4;           ///< of neighbouring centres, in voxels of the shortest edge; at least 1
  double support = 2;                  ///< support radius in center spacings, above 1 and up to 16
  std::string kernel = "wendland-c2";  ///< any compact kernel with a continuous gradient
};

/// One term of a stencil: weight times the value `offset` entries further on.
struct Tap {
  Index offset;
  float weight;
};

/// Part of a row of voxels, count of them, and the level set there. The reader may overwrite value and gradient with
/// the derivatives of its energy by them.
struct LatticeRow {
  std::array<Index, 3> first;  ///< x, y, z of the first voxel
  Index voxel;                 ///< its number, x fastest
  Index stride;                ///< from one voxel to the next
  Index count;
  float* value;
  std::array<float*, 3> gradient;  ///< by the physical coordinates; null when it was not asked for
};

/// The level set of Part IV: f(p) = sum_j alpha_j phi(|p - p_j| / sigma) / S with centres p_j on a regular lattice over
/// the voxels of an image and reaching beyond its border. S is the largest sum of the phi, so that |f| <= 1 wherever
/// |alpha| <= 1.
///
/// Distances are those of space where the centres are equally far apart along all axes. Where the edge of a voxel along
/// an axis is longer than the spacing wanted, the centres are as far apart as the voxels there, and lengths along that
/// axis are divided by the same ratio (stretch()): the support is an ellipsoid that reaches as many centres in each
/// direction.
///
/// Along each axis the spacing of the centres is a whole number p of voxels, or a ratio p / q with q <= 8, within 3 %
/// of what was asked for; the lattice lies symmetrically in the image. So only p^Dim positions of a voxel between the
/// centres exist, its phases; for each phase the sums above are one stencil that slides over the coefficients, without
/// a search or a kernel evaluation per voxel.
///
/// Cost of a sweep: voxels * (volume of the support in center spacings) multiplications, (1 + Dim) times as many with
/// gradients, and the same again for the derivatives by the coefficients. Memory: the coefficients, and per thread
/// (1 + Dim) numbers for the voxels of one phase.
template <int Dim>
class Lattice {
 public:
  /// size, spacing: of the image; lengths are in the unit of `spacing`. Throws InvalidInput for sizes below 2, spacings
  /// that are not positive, and options out of their ranges.
  Lattice(const std::array<Index, 3>& size, const Point<3>& spacing, const LatticeOptions& options = {});

  /// Number of coefficients. Those that no voxel depends on have derivative 0.
  [[nodiscard]] Index coefficients() const { return classes_ * plane_; }

  /// Entries that an array of coefficients must have: what lies behind coefficients() is read, not used.
  [[nodiscard]] Index array_size() const { return coefficients() + slack_; }

  /// Calls row() for all voxels, by several threads, with the values (and, when `gradients`, the gradients) of the
  /// level set with these coefficients (array_size() of them). Returns the sum of what it returns. When `derivatives`
  /// is not null, it gets the derivatives of that sum by the coefficients (array_size() numbers). The order of all
  /// sums, and so every bit, is independent of the number of threads.
  double sweep(const float* coefficients, bool gradients, const std::function<double(const LatticeRow&)>& row,
               float* derivatives) const;

  /// Number of nodes of the lattice along an axis; nodes() is their product.
  [[nodiscard]] Index nodes(int axis) const { return axes_[axis].nodes(); }
  [[nodiscard]] Index nodes() const;
  /// Position of node (0, 0, 0) and the steps to its neighbours, in voxels (the centre of the first voxel is 0).
  [[nodiscard]] Point<Dim> first_node() const;
  [[nodiscard]] Point<Dim> node_step() const;
  /// Number of the coefficient of node (x, y, z).
  [[nodiscard]] Index coefficient(const std::array<Index, 3>& node) const;

  /// Support radius sigma, in the unit of the spacing, along the axes where the stretch is 1.
  [[nodiscard]] double support() const { return support_; }
  /// What lengths along each axis are multiplied by: the shortest distance of centres over that along the axis; 1 for
  /// distances that differ by rounding to ratios only.
  [[nodiscard]] Point<3> stretch() const;
  /// Distance of centres along the axis where it is shortest.
  [[nodiscard]] double center_spacing() const { return center_spacing_; }
  [[nodiscard]] const Kernel& kernel() const { return kernel_; }
  /// 1 / S.
  [[nodiscard]] double scale() const { return scale_; }
  [[nodiscard]] const std::array<Index, 3>& size() const { return size_; }
  [[nodiscard]] const Point<3>& spacing() const { return spacing_; }

  /// Sum of the squares of the weights of a coefficient over all voxels, far from the border.
  [[nodiscard]] double coefficient_weight() const { return coefficient_weight_; }

  /// |grad f| on a plane between coefficients 1 on one side and -1 on the other: the steepest contour.
  [[nodiscard]] double steepest() const { return steepest_; }

 private:
  // One axis: voxel p m + a (a < p) lies at the lattice position q m + (a - middle) q / p; node q (e + first) + c is
  // entry e of the coefficients of class c < q.
  struct Axis {
    Index voxels = 1;
    double edge = 1;     // of a voxel
    double stretch = 1;  // of lengths
    Index p = 1, q = 1;
    Index length = 1;  // of a padded row of one phase or class
    Index first = 0;
    [[nodiscard]] double middle() const { return 0.5 * static_cast<double>(voxels - 1); }
    [[nodiscard]] double step() const { return ratio() * edge * stretch; }  // to the next node, in stretched lengths
    [[nodiscard]] double ratio() const { return static_cast<double>(p) / static_cast<double>(q); }  // voxels per step
    [[nodiscard]] double position(Index a) const { return (static_cast<double>(a) - middle()) / ratio(); }
    [[nodiscard]] Index count(Index a) const { return (voxels - a + p - 1) / p; }  // voxels of phase a
    [[nodiscard]] Index nodes() const { return q * length; }
  };
  // Taps of a phase: offsets into the coefficients, and for each class those from its coefficients back to the voxels,
  // which include the taps of the gradient when there are any.
  struct Phase {
    std::array<Index, 3> at;
    std::array<std::vector<Tap>, 4> forward;               // value, and derivative by x, y, z
    std::vector<std::vector<Tap>> backward;                // [class]: value
    std::vector<std::vector<Tap>> backward_with_gradient;  // [class]
  };

  void make_phase(Phase& phase) const;
  void add_tap(Phase& phase, const std::array<Index, 3>& k) const;
  void normalise();
  [[nodiscard]] double find_steepest() const;
  double sweep_phase(const Phase& phase, const float* coefficients, bool gradients,
                     const std::function<double(const LatticeRow&)>& row, float* workspace, float* derivatives) const;
  double visit_row(const Phase& phase, bool gradients, const std::function<double(const LatticeRow&)>& row,
                   float* workspace, Index y, Index z) const;
  [[nodiscard]] Index part_size() const { return plane_ + 2 * slack_; }  // of the workspace for one component

  std::array<Index, 3> size_;
  Point<3> spacing_;
  Kernel kernel_;
  std::array<Axis, 3> axes_;
  double support_ = 0, center_spacing_ = 0, scale_ = 1, steepest_ = 0, coefficient_weight_ = 0;
  Index classes_ = 1;
  Index plane_ = 1;  // entries of one class
  Index slack_ = 0;  // largest offset and what the sums of taps read further on
  std::vector<Phase> phases_;
  std::shared_ptr<BufferPool> buffers_;
};

}  // namespace csrbf
