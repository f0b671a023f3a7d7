#pragma once

#include "csrbf/core/grid.hpp"

#include <span>
#include <vector>

namespace csrbf {

/// For every voxel the connected component (by faces) of the voxels of one label that it belongs to, or else the one
/// that is nearest by steps along the axes.
struct NearestComponents {
  std::vector<std::int32_t> component;  ///< 0 to count - 1, in the order of their first voxels
  std::size_t count = 0;
};

/// O(voxels); 8 bytes per voxel. When no voxel has the label, all belong to component 0 of 1.
NearestComponents nearest_components(std::span<const std::uint8_t> labels, std::uint8_t label, const Grid& grid);

}  // namespace csrbf
