#pragma once

#include "csrbf/core/types.hpp"

#include <vector>

namespace csrbf {

/// For every point the first one at the same position, itself when there is none before it. 0 and -0 are equal; a point
/// with NaN coordinates coincides with no other. On all threads, O(n). Throws InvalidInput for 2^32 points or more.
template <int Dim>
std::vector<Index> first_coincident(const PointsRef<Dim>& points);

}  // namespace csrbf
