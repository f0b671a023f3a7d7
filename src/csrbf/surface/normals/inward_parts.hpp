#pragma once

#include "csrbf/surface/composite/composite.hpp"

#include <vector>

namespace csrbf {

/// Finds normals that point inward, as some scanners write them: tells for every component, and last for all other
/// samples, whether the mean winding number of the cloud on it is nearly -1/2, where that of a closed surface is 1/2
/// and that of a flat sheet 0. Islands: indices ascending. O(n log n).
std::vector<bool> inward_parts(const OrientedPoints& cloud, const std::vector<std::vector<Index>>& components);

}  // namespace csrbf
