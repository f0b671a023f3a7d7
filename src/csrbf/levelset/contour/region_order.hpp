#pragma once

#include "csrbf/levelset/contour/variational.hpp"
#include "csrbf/levelset/segment_options.hpp"

#include <span>

namespace csrbf {

/// Makes the region that must be inside label 1: the one that the seed marks, or else the one with less of the border
/// of the image; where both have a quarter of it and there is no mask, the one that is convex is likelier inside. More
/// than two regions are brought in the order of their means, empty ones last.
void choose_polarity(const Grid& grid, const SegmentOptions& options, std::span<const float> values,
                     VariationalResult& result);

/// The same for two regions of an image that may be read some slices at a time: by the seed or the border alone.
void choose_polarity_of_large(const Grid& grid, const SegmentOptions& options, VariationalResult& result);

}  // namespace csrbf
