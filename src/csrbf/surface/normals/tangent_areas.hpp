#pragma once

#include "csrbf/core/types.hpp"

namespace csrbf {

/// For every oriented point of a surface the area that it stands for: that of the intersection of its Voronoi cell with
/// its tangent plane, cut off at the square of half side `reach[i]` about it. The areas of points that are spread
/// unevenly, even along lines, add up to that of the surface; cells at the rim of a hole reach to its middle.
/// O(n log n) for evenly spread points.
Eigen::VectorXd tangent_areas(const PointsRef<3>& points, const PointsRef<3>& normals, const Eigen::VectorXd& reach);

}  // namespace csrbf
