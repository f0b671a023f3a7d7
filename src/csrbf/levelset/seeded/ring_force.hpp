#pragma once

#include "csrbf/core/grid.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace csrbf {

struct RingForce {
  std::vector<float> force;
  double contrast = 0;  ///< median of the absolute differences of inside and outside at the contour
};

/// Cost of each voxel inside minus that outside, about a contour that is at most three voxels away: inside are the
/// values of the ring of voxels just within the labels of 1, outside those of the ring just beyond, each near the
/// voxel. What lies beyond may thus differ from one side to the other, and shading does no harm. Negative where the
/// voxel belongs inside; farther from the contour each keeps its side. `mask` may be empty. O(voxels).
RingForce ring_force(std::span<const float> values, const Grid& grid, std::span<const std::uint8_t> mask,
                     std::span<const std::uint8_t> labels);

}  // namespace csrbf
