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

  /// The `each` points of every level that are nearest to x, in ascending order: dense near x, sparse far from it.
  [[nodiscard]] std::vector<Index> around(const Point<Dim>& x, Index each) const;

 private:
  std::vector<Level> levels_;
};

}  // namespace csrbf
