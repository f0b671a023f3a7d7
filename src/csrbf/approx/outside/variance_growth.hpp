#pragma once

#include "csrbf/approx/samples/fitted_field.hpp"
#include "csrbf/approx/samples/samples.hpp"

namespace csrbf {

/// How values differ with the distance, without their noise, so how the variance of a fit grows outside the box of its
/// samples: a power of the distance, up to twice the variance of all values, from pairs of some hundred samples at two
/// distances. `noise`: its variance.
template <int Dim>
typename FittedField<Dim>::Growth variance_growth(const Samples<Dim>& samples, Index component, double noise);

/// The variance of the noise by that of a fit: what it says, or, for want of that, its mean at some hundred samples.
template <int Dim>
double noise_by(const Field<Dim>& variance, const Samples<Dim>& samples);

}  // namespace csrbf
