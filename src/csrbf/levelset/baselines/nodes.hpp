#pragma once

#include "csrbf/core/grid.hpp"
#include "csrbf/core/types.hpp"

namespace csrbf {

/// The centres of a level set.
template <int Dim>
struct Nodes {
  Points<Dim> points;
  /// Size of a regular lattice, x fastest: equal steps along each axis, which makes solving fast. Zeros: scattered
  /// points.
  std::array<Index, Dim> size{};

  [[nodiscard]] bool regular() const { return size[0] > 0; }
};

/// A lattice of counts[a] nodes along each axis, from the first to the last voxel, in physical coordinates. Throws
/// InvalidInput for fewer than 2.
template <int Dim>
Nodes<Dim> regular_nodes(const Grid& grid, const std::array<Index, Dim>& counts);

/// The same with nodes about `spacing` > 0 voxels of the shortest edge apart.
template <int Dim>
Nodes<Dim> regular_nodes(const Grid& grid, double spacing);

/// A lattice of counts[a] >= 2 nodes along each axis of a box, its faces included.
template <int Dim>
Nodes<Dim> regular_nodes(const Box<Dim>& box, const std::array<Index, Dim>& counts);

/// Radius of the largest ball around a point of the domain that contains no node, eq. (3.7). For regular nodes half the
/// diagonal of a cell, otherwise the largest over the points of `domain`. Throws InvalidInput for fewer than 2 nodes.
template <int Dim>
double fill_distance(const Nodes<Dim>& nodes, const PointsRef<Dim>& domain);

}  // namespace csrbf
