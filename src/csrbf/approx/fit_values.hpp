#pragma once

#include "csrbf/approx/fit_options.hpp"
#include "csrbf/approx/samples/samples.hpp"

#include <functional>

namespace csrbf {

/// A fit whose values share all choices.
template <int Dim>
using FitTogether = std::function<Fit<Dim>(const Samples<Dim>&, const FitOptions&)>;

/// Fits several values in groups for which cross-validation of patches makes the same choices (see
/// choose_local_options()): a smooth one beside one with steps does not suffer from it. With several groups the report
/// has FitReport::value_kernels. Values that are the same at all samples are constant, and not counted in its errors.
/// Also heeds FitOptions::standard_deviation.
template <int Dim>
Fit<Dim> fit_values(const Samples<Dim>& samples, const FitOptions& options, const FitTogether<Dim>& fit_together);

}  // namespace csrbf
