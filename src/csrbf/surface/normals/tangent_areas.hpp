#pragma once

#include "csrbf/core/types.hpp"

namespace csrbf {

/// For every oriented point of a surface the area that it represents: that of the intersection of its Voronoi cell with
/// its tangent plane, clipped to the square of half side `reach[i]` around it. The areas of unevenly spread points,
/// even of points along lines, add up to that of the surface; cells at the rim of a hole extend to its middle. O(n log
/// n) for evenly spread points.
Eigen::VectorXd tangent_areas(const PointsRef<3>& points, const PointsRef<3>& normals, const Eigen::VectorXd& reach);

}  // namespace csrbf
