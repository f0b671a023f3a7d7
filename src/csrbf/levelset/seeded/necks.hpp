#pragma once

#include "csrbf/core/grid.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace csrbf {

/// The connected parts (by faces) of the labels of 1 that have most of the voxels of a connected part of the marked
/// ones that any has; no voxels if there is none.
std::vector<std::uint8_t> marked_parts(std::span<const std::uint8_t> labels, std::span<const std::uint8_t> marked,
                                       const Grid& grid);

/// Takes away from what is inside (1) those parts without marked voxels that hang on by a neck: what a ball in the
/// marked part cannot reach, though it is three times as thick, as is what the ball reaches. Returns the radius of the
/// widest neck that was cut, in the unit of the spacing; 0 for none. O(voxels), for each radius tried.
double cut_necks(std::vector<std::uint8_t>& labels, std::span<const std::uint8_t> marked, const Grid& grid);

}  // namespace csrbf
