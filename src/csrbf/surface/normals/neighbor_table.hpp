#pragma once

#include "csrbf/spatial/kd_tree.hpp"

#include <numbers>

namespace csrbf {

/// The k nearest neighbours of every point, nearest first, without the point itself.
struct NeighborTable {
  Index k = 0;
  std::vector<std::uint32_t> index;  ///< k per point
  Eigen::VectorXd reach;             ///< distance to the last neighbour

  [[nodiscard]] std::span<const std::uint32_t> of(Index i) const {
    return {index.data() + i * k, static_cast<std::size_t>(k)};
  }
  [[nodiscard]] Index size() const { return reach.size(); }
  /// Sets the row of point i to the first k of the points `ids`, nearest first, but i.
  void set(Index i, std::span<const Index> ids, const double* squared_distances);
  /// Area of the surface that point i represents if it is smooth: the disc out to the last neighbour has k times that
  /// area.
  [[nodiscard]] double area(Index i) const {
    return std::numbers::pi * reach[i] * reach[i] / static_cast<double>(std::max<Index>(1, k));
  }
};

/// Neighbours of points in Morton order; `k` is lowered to the number of other points. O(n log n), on all threads.
NeighborTable make_neighbor_table(const PointsRef<3>& points, const KdTree<3>& tree, Index k);

/// The table of a subset of a cloud: `points` are the points `kept` (ascending) of the cloud that `before` belongs to.
/// Only rows that lost a neighbour are searched again.
NeighborTable make_neighbor_table(const PointsRef<3>& points, const KdTree<3>& tree, const NeighborTable& before,
                                  const std::vector<Index>& kept);

}  // namespace csrbf
