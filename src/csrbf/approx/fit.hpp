#pragma once

#include "csrbf/approx/fit_options.hpp"
#include "csrbf/approx/samples/samples.hpp"
#include "csrbf/core/field.hpp"

#include <memory>
#include <vector>

namespace csrbf {

/// A function fitted to samples: one field per component of their values.
template <int Dim>
struct Fit {
  std::vector<std::shared_ptr<const Field<Dim>>> components;
  /// Variance of the difference between a sample of mean weight and the component: the error of the function and the
  /// noise of the values together. For interpolate that of kriging (see KrigingVariance), 0 at samples without noise
  /// and growing between them; for partition-of-unity from local leave-one-out errors (see local_variance), outside the
  /// box growing with the distance as the values differ. Empty for the other methods, for interpolation of more than
  /// 4000 samples, and where there are too few samples to estimate it.
  std::vector<std::shared_ptr<const Field<Dim>>> variances = {};
  double variance_unit = 1;  ///< variances are in its square, which keeps those of huge and tiny values finite
  FitReport report = {};
};

/// Fits a smooth function to scattered samples: the entry point of this part of the library. Merges duplicates (their
/// mean counts with their common weight), scales axes of different units, chooses what is not given, and reports it.
/// Throws InvalidInput for invalid samples or options (an unknown method or kernel lists those there are),
/// SolverFailure when a tolerance cannot be met.
template <int Dim>
Fit<Dim> fit(const Samples<Dim>& samples, const FitOptions& options = {});

/// The same for points held as one array each and one value per point: `fit<2>(points, values)` of a
/// std::vector<std::array<double, 2>> and a std::vector<double>.
template <int Dim>
Fit<Dim> fit(std::span<const std::array<double, static_cast<std::size_t>(Dim)>> points, std::span<const double> values,
             const FitOptions& options = {}) {
  return fit<Dim>(make_samples<Dim>(as_points<Dim>(points), Eigen::Map<const Eigen::VectorXd>(
                                                                values.data(), static_cast<Index>(values.size()))),
                  options);
}

}  // namespace csrbf
