#pragma once

#include "csrbf/core/grid.hpp"

#include <optional>
#include <span>
#include <vector>

namespace csrbf {

/// Gives impulses, dead and hot voxels, the median of their neighbours: those of the least and of the greatest value,
/// where single ones, which have no neighbour of their value, are many of either kind, and values close to theirs few;
/// of a value that regions have, too, only single ones. Writes the image to `repaired`, which may be where `values`
/// are, and returns their share; else nothing. `mask`: empty, or 0 where values mean nothing. O(voxels).
std::optional<double> repair_impulses(std::span<const float> values, const Grid& grid,
                                      std::span<const std::uint8_t> mask, std::vector<float>& repaired);

}  // namespace csrbf
