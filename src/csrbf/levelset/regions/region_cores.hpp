#pragma once

#include "csrbf/core/types.hpp"

#include <vector>

namespace csrbf {

/// Label of voxels that belong to no region.
inline constexpr std::uint8_t no_region = 255;

/// The labels, x fastest, with no_region for the voxels that have another label in the box of 2 w + 1 voxels along each
/// axis around them, w = half_width[axis]: voxels at the border between regions, where a blurred image mixes their
/// intensities. Counted as part of the regions they widen the wider law more and more, until its region takes voxels of
/// the others. A region that would keep less than a tenth of its voxels keeps them all. O(n) for any width,
/// parallel. Throws InvalidInput for a negative width and a size that does not fit the labels.
std::vector<std::uint8_t> region_cores(std::span<const std::uint8_t> labels, const std::array<Index, 3>& size,
                                       const std::array<Index, 3>& half_width);

}  // namespace csrbf
