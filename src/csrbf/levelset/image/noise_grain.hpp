#pragma once

#include "csrbf/core/grid.hpp"

#include <span>

namespace csrbf {

/// How many voxels one independent value of the noise covers, which a Gaussian has blurred; 1 where neighbours are
/// independent, or where they are alike far beyond the blur: then they are structure, not noise. `residual`: what is
/// left of an image without its structures; `mask` may be empty. O(voxels).
double noise_grain(std::span<const float> residual, const Grid& grid, std::span<const std::uint8_t> mask);

}  // namespace csrbf
