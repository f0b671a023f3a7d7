#pragma once

#include "csrbf/core/grid.hpp"
#include "csrbf/levelset/regions/force_source.hpp"

namespace csrbf {

/// How noisy a force is.
struct ForceNoise {
  double size = 0;   ///< standard deviation over the difference of the means in the two regions
  double grain = 1;  ///< 1: from voxel to voxel; up to 3 where neighbours are alike, as in speckle
};

/// From second differences of neighbours along x, and of voxels further apart inside the regions. With a large
/// size, single voxels cannot distinguish the regions; it is 1 when the force contradicts the labels.
ForceNoise force_noise(std::span<const float> force, std::span<const std::uint8_t> labels,
                       std::span<const std::uint8_t> mask, const Grid& grid);

/// The largest size and grain of the forces of all regions, of two of the one that there is.
ForceNoise force_noise(const ForceSource& source, std::span<const std::uint8_t> labels,
                       std::span<const std::uint8_t> mask, const Grid& grid);

/// The center spacing for that noise.
double choose_center_spacing(const ForceNoise& noise, int dimension);

/// Mean of |force|.
double mean_magnitude(std::span<const float> force);

}  // namespace csrbf
