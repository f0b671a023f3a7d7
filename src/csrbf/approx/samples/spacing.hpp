#pragma once

#include "csrbf/core/types.hpp"

namespace csrbf {

/// The largest distance of a sample to the nearest centre other than itself: the fill distance of the centres among the
/// samples, and for centres that are all of the samples the largest distance of neighbours. 1 for a single point.
/// O(N log M).
template <int Dim>
double center_spacing(const PointsRef<Dim>& samples, const PointsRef<Dim>& centers);

/// Default support radius of the methods, in spacings of the centres: about 1 + 8 / Dim, which keeps some tens of
/// centres in a support in every dimension.
template <int Dim>
constexpr double default_support() {
  return 1 + 8.0 / Dim;
}

}  // namespace csrbf
