#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>

namespace csrbf {

/// The value that `rank` others, from 0 on, precede when all are sorted. Reorders the values. O(n).
template <class Values>
auto order_statistic(Values&& values, std::ptrdiff_t rank) {
  const auto found = std::begin(values) + rank;
  std::nth_element(std::begin(values), found, std::end(values));
  return *found;
}

/// The middle one of at least one value, the larger of two. Reorders the values. O(n).
template <class Values>
auto median(Values&& values) {
  return order_statistic(values, static_cast<std::ptrdiff_t>(std::size(values) / 2));
}

/// Median of |x| for normal x of standard deviation 1: a robust standard deviation is the median over this.
constexpr double median_of_normal = 0.6745;

/// The value below which a fraction in [0, 1] of the values lies, interpolated linearly between two order statistics.
/// Needs at least one value and reorders them. O(n).
template <class Values>
auto percentile(Values&& values, double fraction) {
  const double position = fraction * static_cast<double>(std::size(values) - 1);
  const auto rank = static_cast<std::ptrdiff_t>(position);
  const auto below = order_statistic(values, rank);
  const double part = position - std::floor(position);
  if (part == 0) return below;
  const auto above = *std::min_element(std::begin(values) + rank + 1, std::end(values));
  return below + static_cast<decltype(below)>(part) * (above - below);
}

}  // namespace csrbf
