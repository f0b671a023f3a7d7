#pragma once

#include "csrbf/core/grid.hpp"

#include <optional>
#include <span>
#include <vector>

namespace csrbf {

/// Gives impulses, dead and hot voxels, the median of their neighbours: those of the least and of the greatest value,
/// where of both there are single ones, none of whose neighbours is near that value, in about the same share of the
/// places where they could be, and few that are close to it but not the same; of a value that regions have, too, only
/// single ones. Writes the image to `repaired`, which may be where `values` are, and returns their share; else nothing.
/// `mask`: empty, or 0 where values mean nothing. O(voxels).
std::optional<double> repair_impulses(std::span<const float> values, const Grid& grid,
                                      std::span<const std::uint8_t> mask, std::vector<float>& repaired);

}  // namespace csrbf
