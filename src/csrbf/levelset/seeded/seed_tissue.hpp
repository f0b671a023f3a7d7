#pragma once

#include "csrbf/core/grid.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace csrbf {

/// What a seed lies in.
struct SeedTissue {
  std::vector<std::uint8_t> labels;  ///< 1 inside
  bool even = false;                 ///< its intensities differ by no more than noise and trend make them
  double neck = 0;                   ///< radius of the widest neck beyond which more of it was cut off; 0: none
  double noise = 0;                  ///< its standard deviation in the image
  bool noisy = false;                ///< one of two classes in the image, which single voxels hardly tell apart
};

/// The connected parts around a seed whose intensities belong to one class, or to those that the seed has: classes of
/// the blurred image, of which the seed's may be one of many, on the scale on which the noise no longer spreads it.
/// Borders are sharpened first, so that no class lies between two others. What necks join to it is cut off
/// (cut_necks()). None where that is most of the image, or no voxel of `seed` is in the mask, which may be empty.
/// `fill`: what it encloses belongs to it, but for holes with a seed of the background (1) in `seeds`, one per voxel or
/// none. `far`: 1 where the tissue is not, one per voxel or none. O(voxels).
std::optional<SeedTissue> find_seed_tissue(std::span<const float> values, const Grid& grid,
                                           std::span<const std::uint8_t> mask, std::span<const std::uint8_t> seed,
                                           bool fill = true, std::span<const std::uint8_t> seeds = {},
                                           std::span<const std::uint8_t> far = {});

}  // namespace csrbf
