#pragma once

#include "csrbf/approx/fit_options.hpp"
#include "csrbf/approx/global/axis_covariance.hpp"

namespace csrbf {

/// Extrapolation::constant or trend, whichever says more of what lies outside the box of a few samples: the outermost
/// ones along every axis, at up to three coordinates on both sides, are left out and predicted from all others by this
/// covariance, or by the value at the nearest point of the box of these. automatic for many samples, constant where
/// these are too few to tell. `samples`: distinct points with positive weights. O(n^3 / 3).
template <int Dim>
Extrapolation best_for_extremes(const Samples<Dim>& samples, const AxisCovariance<Dim>& covariance);

}  // namespace csrbf
