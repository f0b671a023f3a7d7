#pragma once

#include "csrbf/core/grid.hpp"

#include <cstdint>
#include <set>
#include <span>

namespace csrbf {

/// Gives each voxel of a group (0 and above; -1: none) the label of the seed in it (1 + a label; 0: none) that is
/// nearest along paths within the group. The closer to what surrounds the group, the longer are steps, as in the
/// quasi-hyperbolic metric: so borders lie in necks, else about midway, and hardly depend on how many voxels a seed
/// has. Groups without seeds stay, and so do those, whose numbers are returned, where seeds leave open what a label
/// has: where its border could move by the distance to the nearest seed through more than all that it has. Steps lead
/// to all voxels that share a corner. O(n log n); 20 bytes per voxel.
std::set<std::int32_t> nearest_seeds(const Grid& grid, std::span<const std::int32_t> groups,
                                     std::span<const std::uint8_t> seeds, std::span<std::uint8_t> labels);

}  // namespace csrbf
