#pragma once

#include "csrbf/approx/fit_options.hpp"
#include "csrbf/approx/samples/samples.hpp"

namespace csrbf {

/// Fits samples and derivatives, FitOptions::gradients (Hermite): one system up to some thousand unknowns, more as
/// systems of the samples around the cells of a cover. Kernel, length and noise, of values and of derivatives, are
/// those of largest restricted likelihood for blocks of neighbours; the lengths of the axes follow from the sizes of
/// the derivatives. The report lacks the errors at the samples. Throws InvalidInput for options that need another
/// method.
template <int Dim>
Fit<Dim> fit_with_derivatives(const Samples<Dim>& samples, const FitOptions& options);

}  // namespace csrbf
