#pragma once

#include "csrbf/core/types.hpp"

#include <vector>

namespace csrbf {

/// The points with these indices: points(Eigen::all, ids), compiled once.
template <int Dim>
Points<Dim> chosen_points(const PointsRef<Dim>& points, const std::vector<Index>& ids);

/// (x - origin) / scale of each point, likewise.
template <int Dim>
Points<Dim> in_units(const PointsRef<Dim>& points, const Point<Dim>& origin, double scale);

}  // namespace csrbf
