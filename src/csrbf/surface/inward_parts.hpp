#pragma once

#include "csrbf/surface/composite.hpp"

#include <vector>

namespace csrbf {

/// Finds normals that point inward, as some scanners write them: for every island, and last for all other samples,
/// whether the mean winding number of the cloud on it is close to -1/2; it is 1/2 on a closed surface and 0 on a flat
/// sheet. Islands: indices ascending. O(n log n).
std::vector<bool> inward_parts(const OrientedPoints& cloud, const std::vector<std::vector<Index>>& islands);

}  // namespace csrbf
