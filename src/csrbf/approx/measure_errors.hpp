#pragma once

#include "csrbf/approx/fit_options.hpp"
#include "csrbf/approx/samples/samples.hpp"

namespace csrbf {

/// Fills in the errors of FitReport at samples: at some 100,000 of them.
template <int Dim>
void measure_errors(const Samples<Dim>& samples, Fit<Dim>& fit);

/// The samples that a fit has used, without weights: those that are not missing and, for the loss auto, not gross
/// errors.
template <int Dim>
Samples<Dim> fitted_samples(const Samples<Dim>& given, const FitOptions& options, const FitReport& report);

/// Fit::places: all points, or some along a curve and those that span their box where the model is much smaller.
template <int Dim>
std::shared_ptr<const Points<Dim>> places_of(const Samples<Dim>& samples, const FitReport& report);

}  // namespace csrbf
