#pragma once

#include "csrbf/core/grid.hpp"

#include <span>

namespace csrbf {

/// Whether an image takes longer to describe (PartitionPrice), as constant means with a deviation each, when any two
/// regions with labels in a row are joined. False where a region has hardly a voxel.
/// `mask`: 0 in voxels that do not count; may be empty. `values`: finite. `length`: nats for each voxel edge of a
/// contour. O(voxels) for each region.
bool are_all_regions_needed(std::span<const float> values, const Grid& grid, std::span<const std::uint8_t> mask,
                            double length, std::span<const std::uint8_t> labels, int regions);

}  // namespace csrbf
