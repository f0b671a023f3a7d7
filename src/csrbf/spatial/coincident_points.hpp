#pragma once

#include "csrbf/core/types.hpp"

#include <vector>

namespace csrbf {

/// For every point the first one at the same place, itself when there is none before it. 0 and -0 are the same place;
/// points with NaN coordinates are each for themselves. On all threads, O(n). Throws InvalidInput from 2^32 points on.
template <int Dim>
std::vector<Index> first_coincident(const PointsRef<Dim>& points);

}  // namespace csrbf
