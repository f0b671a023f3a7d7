#pragma once

#include "csrbf/core/field.hpp"

#include <vector>

namespace csrbf {

/// First-order distances |f| / |grad f| of points to the surface of a field of slope about 1, divided by `diagonal`.
std::vector<double> surface_distances(const Field<3>& field, const PointsRef<3>& points, double diagonal);

struct DistanceSummary {
  double rms = 0, p99 = 0, max = 0;
};

/// Root mean square, 99th percentile and largest of at least one distance.
DistanceSummary summarize_distances(std::vector<double> distance);

}  // namespace csrbf
