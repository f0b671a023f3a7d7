#pragma once

#include "csrbf/levelset/segment_options.hpp"

namespace csrbf {

/// segment() of an image of one component whose missing voxels are outside the mask, from one start.
template <int Dim>
Segmentation<Dim> segment_known(const Volume<float>& image, const SegmentOptions& options);

}  // namespace csrbf
