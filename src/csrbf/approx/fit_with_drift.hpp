#pragma once

#include "csrbf/approx/fit_options.hpp"
#include "csrbf/approx/samples/drift_field.hpp"
#include "csrbf/approx/samples/samples.hpp"

#include <functional>

namespace csrbf {

/// A fit of any dimension.
struct AnyFit {
  std::vector<AnyField> components, variances;
  FitReport report;
};

template <int Dim>
AnyFit any_fit(Fit<Dim> fit) {
  return {{fit.components.begin(), fit.components.end()},
          {fit.variances.begin(), fit.variances.end()},
          std::move(fit.report)};
}

/// fit() of points (d x n), values (n x k) and weights (n, or empty).
using FitAny = std::function<AnyFit(const Eigen::MatrixXd& points, const Eigen::MatrixXd& values,
                                    const Eigen::VectorXd& weights, const FitOptions& options)>;

/// Fits a function some of whose variables enter linearly, see FitOptions::drift: the coefficients first
/// (estimate_drift()), then by `fit` what they leave. The report lacks the errors at the samples.
template <int Dim>
Fit<Dim> fit_with_drift(const Samples<Dim>& samples, const FitOptions& options, const FitAny& fit);

/// Throws InvalidInput unless FitOptions::drift names axes that leave another one.
void check_drift(const FitOptions& options, int dimension);

}  // namespace csrbf
