#pragma once

#include "csrbf/approx/samples/fitted_field.hpp"
#include "csrbf/approx/samples/samples.hpp"

namespace csrbf {

/// How values differ with the distance, without their noise, so how the variance of a fit grows outside the box of its
/// samples: a power of the distance, up to twice the variance of all values, from pairs of some hundred samples at two
/// distances. `variance`: that of the fit inside, whose mean is the noise.
template <int Dim>
typename FittedField<Dim>::Growth variance_growth(const Samples<Dim>& samples, Index component,
                                                  const Field<Dim>& variance);

}  // namespace csrbf
