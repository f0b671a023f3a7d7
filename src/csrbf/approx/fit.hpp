#pragma once

#include "csrbf/approx/fit_options.hpp"
#include "csrbf/approx/samples/samples.hpp"

namespace csrbf {

/// Fits a smooth function to scattered samples. Start here: fit() merges duplicates (their mean gets the sum of their
/// weights), scales axes of different units, chooses all options that are not given, and reports them. Throws
/// InvalidInput for invalid samples or options, with the list of names for an unknown method or kernel; SolverFailure
/// if a tolerance cannot be met; Cancelled.
template <int Dim>
Fit<Dim> fit(const Samples<Dim>& samples, const FitOptions& options = {});

/// The same for points held as one std::array each, with one value per point: `fit<2>(points, values)` for a
/// std::vector<std::array<double, 2>> and a std::vector<double>.
template <int Dim>
Fit<Dim> fit(std::span<const std::array<double, static_cast<std::size_t>(Dim)>> points, std::span<const double> values,
             const FitOptions& options = {}) {
  return fit<Dim>(make_samples<Dim>(as_points<Dim>(points), Eigen::Map<const Eigen::VectorXd>(
                                                                values.data(), static_cast<Index>(values.size()))),
                  options);
}

}  // namespace csrbf
