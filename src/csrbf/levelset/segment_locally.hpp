#pragma once

#include "csrbf/levelset/segment.hpp"

namespace csrbf {

/// segment() by a contour that moves from its start, with the energy, of means or of means and variances, by whose
/// labels two means describe the image in fewer nats. Internal to segment().
template <int Dim>
Segmentation<Dim> segment_by_best_energy(const Volume<float>& image, SegmentOptions options);

}  // namespace csrbf
