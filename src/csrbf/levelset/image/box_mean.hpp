#pragma once

#include "csrbf/core/types.hpp"

namespace csrbf {

/// Replaces every value of an image, x fastest, by the mean over the box of 2 w + 1 voxels along each axis around it,
/// where w = half_width[axis]; boxes end at the border of the image. With the energies of two regions, or their
/// difference, it gives the windowed likelihood of eq. (8.32). O(n) for any width, parallel; sums are of double
/// precision. Throws InvalidInput for a negative width and a size that does not fit the values.
void box_mean(std::span<float> values, const std::array<Index, 3>& size, const std::array<Index, 3>& half_width);

}  // namespace csrbf
