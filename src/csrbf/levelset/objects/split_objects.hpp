#pragma once

#include "csrbf/core/grid.hpp"

#include <vector>

namespace csrbf {

/// Labels from 1 on for the objects inside (not 0), touching ones split: basins of the distance to the outside, joined
/// by join_basins(). Where the image has valleys inside, basins between these are joined too: of each connected part
/// the labels count whose shapes are described in fewer nats, if at least half of the valleys are borders then. Those
/// of textures are not. O(n log n).
std::vector<std::int32_t> split_objects(const Volume<float>& image, const std::vector<std::uint8_t>& inside);

}  // namespace csrbf
