#pragma once

#include "csrbf/surface/reconstruct.hpp"

namespace csrbf {

/// First-order distances |f| / |grad f| of points to the surface of a field of slope about 1, divided by `diagonal`.
std::vector<double> surface_distances(const Field<3>& field, const PointsRef<3>& points, double diagonal);

/// Writes root mean square, 99th percentile and largest of at least one distance.
void summarize_distances(std::vector<double> distance, ReconstructReport& report);

}  // namespace csrbf
