#pragma once

#include "csrbf/levelset/convex/convex_contour.hpp"

#include <string>
#include <vector>

namespace csrbf {

/// How much contours cost, and how many voxels one independent value covers.
struct LevelPrice {
  ContourWeight weight;
  double grain = 1;
};

/// Adds a warning that names the levels of intensity that each of two regions consists of, if there are any, and how
/// many regions there may be: two or three levels of a region, each a constant and noise, are classes of least variance
/// of its blurred voxels. They have to be worth their contours against one mean that varies as a quadratic, as far
/// apart as a good part of what the two regions are, and constant: light, objects of varied brightness and textures
/// leave structures in each class. Voxels close to the other region may be its blurred border and do not count.
///
/// `labels`: 0 and 1; `mask` (0: does not count) may be empty. O(voxels).
void warn_of_levels(std::span<const float> values, std::span<const std::uint8_t> labels, const Grid& grid,
                    std::span<const std::uint8_t> mask, const LevelPrice& price, std::vector<std::string>& warnings);

}  // namespace csrbf
