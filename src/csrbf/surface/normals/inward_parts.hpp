#pragma once

#include "csrbf/surface/composite/composite.hpp"

namespace csrbf {

/// Finds normals that point inward, as some scanners write them: for every component, and last for all other samples,
/// whether the mean winding number of the cloud on it is close to -1/2; it is 1/2 on a closed surface and 0 on a flat
/// sheet. Islands: indices ascending. O(n log n).
std::vector<bool> inward_parts(const OrientedPoints& cloud, const std::vector<std::vector<Index>>& components);

}  // namespace csrbf
