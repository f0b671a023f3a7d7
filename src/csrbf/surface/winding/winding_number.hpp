#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/surface/winding/winding_tree.hpp"

#include <memory>

namespace csrbf {

namespace winding {
struct MadeCubes;
}

/// The generalised winding number of oriented samples of a surface, regularised near the samples:
///   w(x) = sum_i a_i n_i . (p_i - x) / (4 pi (|p_i - x|^2 + eps_i^2)^(3/2)),   u = 2 w - 1,
/// so that u -> 1 inside a closed surface, -1 outside, and u = t / sqrt(t^2 + eps^2) at the depth t below a nearly flat
/// part of it: a field with the library's sign convention, defined and smooth everywhere (Barill et al. 2018; softened
/// like gravity in particle simulations).
///
/// Samples far from a point act through the second-order moments of the nodes of a tree and, in a cube of space,
/// through one tricubic polynomial (Greengard and Rokhlin 1987, interpolating as Fong and Darve 2009). The error of u
/// is below 2e-3, mostly 2e-4, with jumps of that size at the faces of the cubes. Arithmetic in single precision
/// relative to the cube. The value at a point does not depend on what else is evaluated, when, or on which thread.
///
/// Construction O(n log n). The polynomial of a cube is computed when a point in it is first evaluated and shared by
/// all copies of the field; then a value takes O(1), independent of n. Memory: about 95 bytes per sample, plus 40 once
/// the whole neighbourhood of the surface has been visited.
class WindingNumber final : public Field<3> {
 public:
  /// All that is needed to rebuild the field: points p, outward unit normals n (zero excludes a sample), areas a >= 0
  /// of the part of the surface a sample represents, smoothing lengths eps > 0 of about the distance between samples.
  using Data = winding::Samples;

  /// No samples: u = -1.
  WindingNumber() = default;

  /// Throws InvalidInput if sizes differ, an entry is not finite, an area is negative or a smoothing length is not
  /// positive.
  explicit WindingNumber(const Data& data);
  /// Of a tree that was made before, see tree().
  explicit WindingNumber(winding::Tree tree);
  /// ... with cubes made before. Throws InvalidInput if they are not of this tree.
  WindingNumber(winding::Tree tree, const winding::MadeCubes& cubes);
  WindingNumber(const PointsRef<3>& points, const PointsRef<3>& normals, const Eigen::Ref<const Eigen::VectorXd>& areas,
                const Eigen::Ref<const Eigen::VectorXd>& eps);

  void evaluate_block(const PointsRef<3>& x, const JetBlock& out) const override;

  /// Bounding box of the samples.
  [[nodiscard]] Box<3> bounds() const override;
  /// The samples.
  [[nodiscard]] Points<3> seeds() const override;

  /// The samples in the order of the tree; normals, areas and smoothing lengths rounded to single precision. A field
  /// built from them is bit-identical.
  [[nodiscard]] Data data() const;
  /// The samples and what has been made of them, for a field that is bit-identical too.
  [[nodiscard]] const winding::Tree& tree() const;
  /// What evaluation has added to it so far; not while the field is evaluated.
  [[nodiscard]] winding::MadeCubes made_cubes() const;

 private:
  struct Impl;
  std::shared_ptr<const Impl> impl_;
};

}  // namespace csrbf
