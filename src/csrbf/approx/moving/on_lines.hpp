#pragma once

#include "csrbf/core/types.hpp"

namespace csrbf {

/// Whether points lie on lines, as those of wells, casts, flights, or stations with time as an axis do: dense along
/// them and far apart, so that the neighbours of many points are on one line with them. With coordinates as they are,
/// or divided by their extents. O(n log n).
template <int Dim>
bool on_lines(const PointsRef<Dim>& points);

}  // namespace csrbf
