#pragma once

#include "csrbf/approx/fit.hpp"

namespace csrbf {

/// Continues a fit another way outside the box of its samples; not `automatic`. Variances that a covariance gives
/// outside, too, become the mean squares of the errors of what is returned there: a function that is made constant is
/// as wrong as it differs from what is likely. Throws InvalidInput for a field without samples or with a drift.
template <int Dim>
void extrapolate(Fit<Dim>& fit, Extrapolation extrapolation);

/// The variances of the fields of a fit, of which likelier fields and their variances are known.
template <int Dim>
std::vector<std::shared_ptr<const Field<Dim>>> variances_by(
    const std::vector<std::shared_ptr<const Field<Dim>>>& fields,
    const std::vector<std::shared_ptr<const Field<Dim>>>& likely,
    const std::vector<std::shared_ptr<const Field<Dim>>>& variances);

/// The same where the likelier ones are those of the fit that follow its trend outside.
template <int Dim>
void count_errors_outside(Fit<Dim>& fit);

}  // namespace csrbf
