#pragma once

#include "csrbf/core/types.hpp"

#include <vector>

namespace csrbf {

/// Distance of every voxel of a lattice to the nearest marked one, centre to centre: 0 where marked, infinity when none
/// is. Voxels are `spacing` apart along orthogonal axes; x is the fastest axis, `marked` has one entry per voxel. Exact
/// up to the rounding of float (Felzenszwalb and Huttenlocher 2012, one axis after the other). O(voxels), on all
/// threads. Throws InvalidInput when sizes do not match or a spacing is not positive and finite.
std::vector<float> distance_transform(const std::array<Index, 3>& size, const Point<3>& spacing,
                                      const std::vector<std::uint8_t>& marked);

}  // namespace csrbf
