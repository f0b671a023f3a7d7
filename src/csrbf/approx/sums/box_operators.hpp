#pragma once

#include "csrbf/approx/sums/chebyshev.hpp"
#include "csrbf/kernels/kernel.hpp"

#include <array>
#include <map>
#include <vector>

namespace csrbf {

/// Difference of the cells of two boxes of one size, in boxes.
template <int Dim>
using BoxOffset = std::array<int, Dim>;

/// Expansions of phi(|x - y|) between cubes of one size that are at least one cube apart: the black-box fast multipole
/// method (Fong and Darve 2009). Inside a box the kernel is a polynomial of degree order - 1 in each coordinate, known
/// at Chebyshev nodes; of the functions of the nodes only the `rank` that matter, by singular values, are kept:
///
///     phi(|x_i - y_j|) = sum_ab (S U)_ia C_ab (S U)_jb,   S the Lagrange polynomials, U the basis
///
/// Each function of the basis is even or odd in each coordinate, so that offsets that differ in signs share C. Order
/// and rank are the smallest for which the error, measured on pairs of points, is below `tolerance` times the kernel's
/// size: for kernels with a scale that of phi(0), or of phi at this distance when it grows; else the latter.
template <int Dim>
class BoxOperators {
 public:
  enum class Reach {
    near,       ///< not smooth enough: sum directly, or look at smaller boxes
    far,        ///< by the expansions
    negligible  ///< phi is below the tolerance
  };

  /// `half`: half the side of the boxes in units of the support. `farthest`: largest offset along an axis that will be
  /// asked for.
  /// `has_parent`: expansions will come from larger boxes, even if none is far here.
  BoxOperators(const Kernel& kernel, double half, double tolerance, int farthest, bool has_parent);

  /// For an offset of at least 2 along an axis, with entries >= 0.
  [[nodiscard]] Reach reach(const BoxOffset<Dim>& offset) const;
  /// Whether boxes at an offset of at least 2 may be near.
  [[nodiscard]] bool any_near() const { return any_near_; }
  [[nodiscard]] int farthest() const { return farthest_; }

  [[nodiscard]] Index rank() const { return rank_; }  ///< padded to a multiple of panel_rows
  [[nodiscard]] const Chebyshev& chebyshev() const { return chebyshev_; }
  /// Node (a, b, c) is row slab() * a + b + order c.
  [[nodiscard]] Index slab() const { return slab_; }
  [[nodiscard]] const Eigen::MatrixXd& basis() const { return basis_; }              ///< U, nodes x rank
  [[nodiscard]] const Eigen::MatrixXd& transposed() const { return transposed_; }    ///< U^T
  [[nodiscard]] const std::vector<unsigned>& odd_axes() const { return odd_axes_; }  ///< per function, as bits

  /// In half boxes from the centre; padding lies at 0.
  [[nodiscard]] Points<Dim> nodes() const;

  /// Index of an offset with entries >= 0.
  [[nodiscard]] Index code(const BoxOffset<Dim>& offset) const;

  /// Computes C for these codes.
  void prepare(std::vector<Index> codes);
  /// C, rank x rank, once prepared.
  [[nodiscard]] const Eigen::MatrixXd& translation(Index code) const { return translations_.at(code); }

  /// From the expansion of child `corner` (bit d: the upper half along axis d), in boxes of half the size, to that of
  /// its parent here: rank x child.rank. Its transpose leads down.
  [[nodiscard]] Eigen::MatrixXd to_parent(const BoxOperators& child, unsigned corner) const;

 private:
  [[nodiscard]] BoxOffset<Dim> offset(Index code) const;
  [[nodiscard]] Eigen::MatrixXd kernel_matrix(const Points<Dim>& x, const Points<Dim>& y) const;
  [[nodiscard]] double scale() const;
  [[nodiscard]] bool is_negligible(const BoxOffset<Dim>& offset) const;
  void measure(double limit);
  void find_basis(double tolerance);

  Kernel kernel_;
  double half_;
  int farthest_;
  Chebyshev chebyshev_;
  Index slab_ = 0;
  Index rank_ = 0;
  double negligible_ = 0;
  bool any_near_ = false;
  std::vector<Reach> reach_;
  Eigen::MatrixXd basis_;
  Eigen::MatrixXd transposed_;
  std::vector<unsigned> odd_axes_;
  std::map<Index, Eigen::MatrixXd> translations_;
};

}  // namespace csrbf
