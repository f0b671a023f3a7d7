#pragma once

#include "csrbf/levelset/segment.hpp"

namespace csrbf {

/// Whether the energy of a contour that moves from its start is to be chosen: it is `automatic`, and nothing else that
/// is given belongs to one of them.
bool chooses_local_energy(const SegmentOptions& options, Index voxels);

/// Means, and means with a variance each: the contour that describes the image as two regions of constant means and
/// equal variances in fewer nats. A contour of variances is often the better one for means, too: it is not drawn to
/// where these say so little that it leaks. Each is followed to its end.
template <int Dim>
Segmentation<Dim> segment_by_best_energy(const Volume<float>& image, SegmentOptions options);

}  // namespace csrbf
