#pragma once

#include "csrbf/core/grid.hpp"
#include "csrbf/core/types.hpp"

namespace csrbf {

/// Places of the centres of a level set.
template <int Dim>
struct Nodes {
  Points<Dim> points;
  /// Of a regular lattice, x fastest: equal steps along each axis, which makes systems fast. Zeros: scattered points.
  std::array<Index, Dim> size{};

  [[nodiscard]] bool regular() const { return size[0] > 0; }
};

/// A lattice of counts[a] >= 2 nodes from the first to the last voxel along each axis, in physical coordinates. Throws
/// InvalidInput for fewer.
template <int Dim>
Nodes<Dim> regular_nodes(const Grid& grid, const std::array<Index, Dim>& counts);

/// The same with nodes about `spacing` > 0 voxels of the shortest edge apart.
template <int Dim>
Nodes<Dim> regular_nodes(const Grid& grid, double spacing);

/// A lattice of counts[a] >= 2 nodes over a box, its faces included.
template <int Dim>
Nodes<Dim> regular_nodes(const Box<Dim>& box, const std::array<Index, Dim>& counts);

/// Radius of the largest ball around a point of the domain without a node, eq. (3.7): half the diagonal of a cell of
/// regular nodes, else over the points of `domain`. Throws InvalidInput for fewer than 2 nodes.
template <int Dim>
double fill_distance(const Nodes<Dim>& nodes, const PointsRef<Dim>& domain);

}  // namespace csrbf
