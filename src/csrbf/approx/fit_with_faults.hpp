#pragma once

#include "csrbf/approx/fit_options.hpp"
#include "csrbf/approx/samples/samples.hpp"

namespace csrbf {

/// Fits samples in the plane that faults, FitOptions::faults, divide: local functions by kriging from the samples
/// around anchors that see them past the faults, blended (see FaultField). The covariance is that of largest restricted
/// likelihood for such neighbourhoods. The report lacks the errors at the samples. Throws InvalidInput for other
/// dimensions, and options that need another method.
Fit<2> fit_with_faults(const Samples<2>& samples, const FitOptions& options);

}  // namespace csrbf
