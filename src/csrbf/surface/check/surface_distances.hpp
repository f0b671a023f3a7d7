#pragma once

#include "csrbf/core/field.hpp"

namespace csrbf {

/// First-order distances |f| / |grad f| of points to the surface of a field of slope about 1, divided by `diagonal`.
std::vector<double> surface_distances(const Field<3>& field, const PointsRef<3>& points, double diagonal);

}  // namespace csrbf
