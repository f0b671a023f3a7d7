#pragma once

#include "csrbf/levelset/segment.hpp"

namespace csrbf {

template <int Dim>
using SegmentOnce = std::function<Segmentation<Dim>(const SegmentOptions&)>;

/// A contour that moves from its seed, seeds or start: of the energy that describes the image better, where that may be
/// chosen. From a seed or seeds, unless there is a force, once more from where it came to rest, on centres no farther
/// apart than the size of what it found asks for, until it stays.
template <int Dim>
Segmentation<Dim> segment_locally(const Volume<float>& image, SegmentOptions options, const SegmentOnce<Dim>& once);

}  // namespace csrbf
