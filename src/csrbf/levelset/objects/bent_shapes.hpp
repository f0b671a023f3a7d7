#pragma once

#include "csrbf/core/types.hpp"

#include <limits>
#include <span>

namespace csrbf {

/// Shares of the points of a shape that lie outside of an ellipsoid and of a rod with round ends, each bent along an
/// arc, with the moments and the size of the shape. Infinite where there is none.
struct BentShapes {
  double ellipsoid = std::numeric_limits<double>::infinity();
  double rod = std::numeric_limits<double>::infinity();
};

/// The arc of least squares, in the plane (of a shape in space: in that of its longest axis in which it is bent most);
/// none of shapes that are hardly bent or more than about half a ring. Points, the middles of
/// voxels of size `voxel` (all or some of them), evenly spread over a shape of that area or volume, in 2 or 3
/// dimensions, with 0 for the third of 2. O(points).
BentShapes fit_bent_shapes(std::span<const Point<3>> points, double size, double voxel, int dim);

}  // namespace csrbf
