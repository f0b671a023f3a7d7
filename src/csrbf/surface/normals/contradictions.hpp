#pragma once

#include "csrbf/surface/normals/neighbor_table.hpp"

namespace csrbf {

/// Tells neighbours whose normals contradict each other, because one of them is wrong, from those that face opposite
/// ways because they lie on the two sheets of a plate or gap thinner than their distance. The latter stand higher over
/// each other's tangent planes than neighbours whose normals agree: that is measured first, O(n).
class Contradictions {
 public:
  Contradictions(const Points<3>& points, const Points<3>& normals, const NeighborTable& near);

  /// Whether the points i and j have opposite normals, but lie beside each other.
  [[nodiscard]] bool between(const Points<3>& normals, Index i, Index j) const;
  /// Share of such pairs among the nearest neighbours of all points.
  [[nodiscard]] double share(const Points<3>& normals) const;

  static constexpr double same_side = 0.5;  ///< cosine between normals that agree. Chosen by hand

 private:
  [[nodiscard]] double rise(const Points<3>& normals, Index i, Index j) const;

  const Points<3>& points_;
  const NeighborTable& near_;
  double largest_rise_ = 1;
};

}  // namespace csrbf
