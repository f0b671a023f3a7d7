#pragma once

#include "csrbf/approx/samples/samples.hpp"

namespace csrbf {

/// Larger ones are rejected, as squares of distances, and sums and slopes of values, might overflow (at 1.8e308).
inline constexpr double largest_coordinate = 1e150, largest_value = 1e250;

/// Throws InvalidInput in the name of `function` unless the samples are valid and within these limits.
template <int Dim>
void require_within_limits(const Samples<Dim>& samples, const char* function) {
  require_valid(samples, function);
  const double coordinate = samples.points.cwiseAbs().maxCoeff(), value = samples.values.cwiseAbs().maxCoeff();
  require(coordinate <= largest_coordinate, function, "points", coordinate, "must not exceed 1e150; use another unit");
  require(value <= largest_value, function, "values", value, "must not exceed 1e250; use another unit");
}

}  // namespace csrbf
