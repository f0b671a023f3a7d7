#pragma once

#include "csrbf/levelset/partition/convex_contour.hpp"

#include <optional>
#include <string>
#include <vector>

namespace csrbf {

/// Levels of intensity that one of two regions consists of.
struct RegionLevels {
  std::vector<double> means;  ///< two or three, ascending
  double nats = 0;            ///< that describing each level by its own mean saves
};

/// How much contours cost, and how many voxels one independent value covers.
struct LevelPrice {
  ContourWeight weight;
  double grain = 1;
};

/// Whether region `label` of two consists of two or three levels, each a constant and noise: classes of least variance
/// of its blurred voxels. They have to be worth their contours against one mean that varies as a quadratic, as far
/// apart as a good part of what the two regions are, and constant: light, objects of varied brightness and textures
/// leave structures in each class. Voxels close to the other region may be its blurred border and do not count. `mask`
/// (0: does not count) may be empty. The levels that save most; O(voxels).
std::optional<RegionLevels> find_region_levels(std::span<const float> values, std::span<const std::uint8_t> labels,
                                               int label, const Grid& grid, std::span<const std::uint8_t> mask,
                                               const LevelPrice& price);

/// Adds a warning that names the levels of both regions, if there are any, and how many regions there may be.
void warn_of_levels(std::span<const float> values, std::span<const std::uint8_t> labels, const Grid& grid,
                    std::span<const std::uint8_t> mask, const LevelPrice& price, std::vector<std::string>& warnings);

}  // namespace csrbf
