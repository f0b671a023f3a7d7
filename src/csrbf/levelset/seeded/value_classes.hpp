#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace csrbf {

/// Bins at which the classes of a histogram begin, and its number of bins: the intervals of shortest description by a
/// Gaussian each, by dynamic programming, of at most seven classes. A sample says as much as `independent` independent
/// ones. O(bins^2).
std::vector<std::size_t> value_classes(std::span<const double> histogram, double independent);

}  // namespace csrbf
