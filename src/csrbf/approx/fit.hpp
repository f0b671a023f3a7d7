#pragma once

#include "csrbf/approx/fit_options.hpp"
#include "csrbf/approx/samples/samples.hpp"

namespace csrbf {

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
