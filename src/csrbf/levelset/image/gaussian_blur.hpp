#pragma once

#include "csrbf/core/types.hpp"

namespace csrbf {

/// Convolves an image, x fastest, with a Gaussian of standard deviation sd[axis] voxels along each axis, cut at 4 sd;
/// the image goes on as its mirror image beyond its border. As a matrix it is symmetric, and constants stay as they
/// are. O(n sd), parallel. Throws InvalidInput for a negative or infinite sd and a size that does not fit the values.
void gaussian_blur(std::span<float> values, const std::array<Index, 3>& size, const std::array<double, 3>& sd);

}  // namespace csrbf
