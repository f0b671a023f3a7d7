#pragma once

#include "csrbf/core/grid.hpp"
#include "csrbf/levelset/segment_options.hpp"

#include <vector>

namespace csrbf {

/// Number of connected components (by the faces of voxels) of all labels but 0. O(n).
Index count_components(std::span<const std::uint8_t> labels, const Grid& grid);

/// Fills holes: labels of 0 that are not connected to the border of the image become 1, but for holes in which a voxel
/// of `seeds` (one each, or none) is 1, a seed of the background. O(n). Returns their number.
Index fill_enclosed(std::span<std::uint8_t> labels, const Grid& grid, std::span<const std::uint8_t> seeds = {});

/// Which of two regions a seed marks as inside: the one of which it covers the larger share; -1 when it covers both
/// alike.
int seeded_region(std::span<const std::uint8_t> labels, std::span<const std::uint8_t> seed,
                  std::span<const std::uint8_t> mask);

/// Adds the voxels of each label at the border of the image, in its slices [begin, end), whose labels these are; labels
/// beyond the last count as the last. `mask`: of the whole image; may be empty.
void count_border(std::span<const std::uint8_t> labels, const Grid& grid, std::span<const std::uint8_t> mask,
                  Index begin, Index end, std::span<Index> counts);

/// The region that holds most of the voxels at the border of the image, or of the mask where that has a border.
int border_region(std::span<const std::uint8_t> labels, const Grid& grid, std::span<const std::uint8_t> mask,
                  int regions);

/// Voxels, volume, mean and standard deviation of each region over the mask.
std::vector<RegionReport> measure_regions(std::span<const std::uint8_t> labels, std::span<const float> values,
                                          const Grid& grid, std::span<const std::uint8_t> mask, int regions);

}  // namespace csrbf
