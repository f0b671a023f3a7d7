#pragma once

#include "csrbf/core/grid.hpp"

#include <cstdint>
#include <span>

namespace csrbf {

/// Gives each voxel of a group (0 and above; -1: none) the label of the seed in it (1 + a label; 0: none) that is
/// nearest along paths within the group. The closer to what surrounds the group, the longer are steps, as in the
/// quasi-hyperbolic metric: so borders lie in necks, else about midway, and hardly depend on how many voxels a seed
/// has. Groups without seeds stay. Steps lead to all voxels that share a corner. O(n log n); 16 bytes per voxel.
void nearest_seeds(const Grid& grid, std::span<const std::int32_t> groups, std::span<const std::uint8_t> seeds,
                   std::span<std::uint8_t> labels);

}  // namespace csrbf
