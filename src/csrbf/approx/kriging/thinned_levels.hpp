#pragma once

#include "csrbf/core/types.hpp"
#include "csrbf/spatial/kd_tree.hpp"

#include <memory>
#include <vector>

namespace csrbf {

/// Nested subsets of points, evenly spread: all of them, a quarter, a sixteenth, ... The last one has 100 to 400.
template <int Dim>
class ThinnedLevels {
 public:
  /// O(n log n).
  explicit ThinnedLevels(const Points<Dim>& points);

  struct Level {
    std::vector<Index> indices;  ///< of the points, along a curve that keeps neighbours together
    Points<Dim> points;
    std::unique_ptr<const KdTree<Dim>> tree;
  };
  [[nodiscard]] const std::vector<Level>& levels() const { return levels_; }

  /// Points on all sides of x, in ascending order, dense near x and sparse far from it: the `nearest` ones, and of
  /// every level the `each` nearest in each of `cones` directions, among the nearest ones of the level, or among all of
  /// the last one where these are not on all sides.
  [[nodiscard]] std::vector<Index> around(const Point<Dim>& x, Index nearest, Index each) const;
  /// Directions by their largest and second largest coordinates, and their signs: of equal size, by symmetry.
  static constexpr Index cones = Dim == 1 ? 2 : 4 * Dim * (Dim - 1);

 private:
  std::vector<Level> levels_;
};

}  // namespace csrbf
