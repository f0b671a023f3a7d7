#pragma once

#include "csrbf/core/grid.hpp"

#include <span>
#include <vector>

namespace csrbf {

/// For every voxel the connected component (by faces) of the voxels of one label that it belongs to.
struct VoxelComponents {
  std::vector<std::int32_t> component;  ///< 0 to count - 1, in the order of their first voxels; -1: none
  std::size_t count = 0;
};

/// O(voxels).
VoxelComponents voxel_components(std::span<const std::uint8_t> labels, std::uint8_t label, const Grid& grid);

/// The same, and for voxels of other labels the component that is nearest by steps along the axes. When no voxel has
/// the label, all belong to component 0 of 1. O(voxels), two sweeps; 8 bytes per voxel.
VoxelComponents nearest_components(std::span<const std::uint8_t> labels, std::uint8_t label, const Grid& grid);

}  // namespace csrbf
