#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace csrbf {

/// The value below which a fraction in [0, 1] of the values lies, interpolated linearly between two order statistics.
/// Needs at least one value and reorders them. O(n).
template <class Scalar>
Scalar percentile(std::vector<Scalar>& values, double fraction) {
  const double position = fraction * static_cast<double>(values.size() - 1);
  const auto below = values.begin() + static_cast<std::ptrdiff_t>(position);
  std::nth_element(values.begin(), below, values.end());
  const double part = position - std::floor(position);
  if (part == 0) return *below;
  const Scalar above = *std::min_element(below + 1, values.end());
  return *below + static_cast<Scalar>(part) * (above - *below);
}

}  // namespace csrbf
