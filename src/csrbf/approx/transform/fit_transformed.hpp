#pragma once

#include "csrbf/approx/fit_options.hpp"
#include "csrbf/approx/samples/samples.hpp"

#include <functional>
#include <optional>

namespace csrbf {

/// Fits by `fit` the square roots or logarithms of values where FitOptions::transform says so, or finds that they are
/// much likelier; none where no value is transformed. The report lacks the errors at the samples.
template <int Dim>
std::optional<Fit<Dim>> fit_transformed(
    const Samples<Dim>& samples, const FitOptions& options,
    const std::function<Fit<Dim>(const Samples<Dim>& samples, const FitOptions& options)>& fit);

/// Throws InvalidInput unless FitOptions::transform is one that goes with the other options.
void check_transform(const FitOptions& options);

}  // namespace csrbf
