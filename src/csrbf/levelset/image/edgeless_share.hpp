#pragma once

#include "csrbf/core/grid.hpp"

#include <span>

namespace csrbf {

/// The share of the border between two regions that is no edge: where the means of the voxels close by on both sides
/// differ by less than a tenth of what they typically do at this border, or the other way round. `mask` may be empty.
double edgeless_share(std::span<const float> values, std::span<const std::uint8_t> labels, const Grid& grid,
                      std::span<const std::uint8_t> mask);

/// What the regions differ by from one voxel to the next across their border, of what the means of the voxels close by
/// on both sides do: 1 where borders are sharp, less than half where a camera blurs them, as it nearly always does. 0
/// where edges of both signs cancel.
double border_sharpness(std::span<const float> values, std::span<const std::uint8_t> labels, const Grid& grid,
                        std::span<const std::uint8_t> mask);

}  // namespace csrbf
