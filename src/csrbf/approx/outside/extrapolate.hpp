#pragma once

#include "csrbf/approx/fit_options.hpp"
#include "csrbf/approx/samples/samples.hpp"
#include "csrbf/core/field.hpp"

#include <memory>
#include <vector>

namespace csrbf {

/// Continues the fields of a fit another way outside the box of its samples; not `automatic`. Variances that a
/// covariance gives outside, too (`has_trend`), become the mean squares of the errors of what is returned there: a
/// function that is made constant is as wrong as it differs from what is likely. Throws InvalidInput for a field
/// without samples or with a drift.
template <int Dim>
void extrapolate(std::vector<std::shared_ptr<const Field<Dim>>>& components,
                 std::vector<std::shared_ptr<const Field<Dim>>>& variances, bool has_trend,
                 Extrapolation extrapolation);

/// The variances of the fields of a fit, of which likelier fields and their variances are known.
template <int Dim>
std::vector<std::shared_ptr<const Field<Dim>>> variances_by(
    const std::vector<std::shared_ptr<const Field<Dim>>>& fields,
    const std::vector<std::shared_ptr<const Field<Dim>>>& likely,
    const std::vector<std::shared_ptr<const Field<Dim>>>& variances);

/// The same where the likelier ones are those fields that follow their trend outside.
template <int Dim>
std::vector<std::shared_ptr<const Field<Dim>>> with_errors_outside(
    const std::vector<std::shared_ptr<const Field<Dim>>>& fields,
    const std::vector<std::shared_ptr<const Field<Dim>>>& variances);

/// Outside the box deviations are at most the range of the values, and grow with the distance in extents of the box:
/// those of logarithms become factors beyond all bounds. Few samples do not know the range.
template <int Dim>
void bound_outside(const Samples<Dim>& samples, std::vector<std::shared_ptr<const Field<Dim>>>& variances);

}  // namespace csrbf
