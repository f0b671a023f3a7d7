#pragma once

#include "csrbf/core/grid.hpp"

#include <span>
#include <vector>

namespace csrbf {

/// The voxels from lo to hi, inclusive.
struct VoxelBox {
  std::array<Index, 3> lo, hi;
};

/// Area (2D: length) of the boundary of the voxels with that label, all of which lie in the box: the integral of the
/// slope of their image with an edge blurred by one voxel (co-area formula). Within 2 % for balls of radii from 4
/// voxels on; less for smaller ones. What lies beyond the image is outside.
double object_area(std::span<const std::int32_t> labels, std::int32_t label, const VoxelBox& box, const Grid& grid);

}  // namespace csrbf
