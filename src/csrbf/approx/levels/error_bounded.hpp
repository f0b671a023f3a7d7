#pragma once

#include "csrbf/approx/levels/level_fit.hpp"
#include "csrbf/approx/samples/samples.hpp"

#include <string>

namespace csrbf {

template <int Dim>
class LevelBuilder;

struct ErrorBoundedOptions {
  std::string kernel = "wendland-c2";  ///< compactly supported
  /// Largest error at any sample, in the unit of the values; unset: 1 % of their range.
  std::optional<double> tolerance = {};
  /// Budget of the first level; 0: a fiftieth of the samples.
  Index centers = 0;
  /// Support radius, above 1: on the first level in scales of the Voronoi cells, on others in separation distances of
  /// the centres.
  double support = 3;
  double reduction = 0.5;                ///< of the separation distance from level to level; between 0 and 1
  std::optional<double> lambda0 = 1e-6;  ///< regularisation, see RidgeOptions::lambda0; unset: chosen from the data
  Index max_levels = 30;                 ///< before the last level, which removes the remaining errors
  Progress progress = {};                ///< stages of fixed_budget() and "levels"
};

/// Approximates within a tolerance at every sample (thesis section 3.3). The first level is fixed_budget(). Each
/// further level adds farthest points until they are `reduction` times as far apart (mu in the thesis), keeps those
/// where the error exceeds the tolerance, and fits the residual with narrower supports (eq. 3.13, with the separation
/// distance of all farthest points). Samples that still exceed the tolerance at the end get a basis function each that
/// vanishes at all other samples. So **the bound always holds, at every sample**, up to rounding (1e-12 of the range).
///
/// Several samples at one point are replaced by the midpoint of their range; the bound holds for each of them.
///
/// Throws InvalidInput for invalid samples or options; SolverFailure if samples at the same point differ by more than
/// twice the tolerance, since no function is close to both, and if the tolerance is below the last digit of the largest
/// value.
template <int Dim>
LevelFit<Dim> error_bounded(const Samples<Dim>& samples, const ErrorBoundedOptions& options = {});

/// The tolerance used: the given one, or 1 % of the range. Throws InvalidInput in the name of `function` if it is
/// negative or not finite; SolverFailure as error_bounded().
template <int Dim>
double checked_tolerance(const LevelBuilder<Dim>& builder, std::optional<double> tolerance, const char* function);

}  // namespace csrbf
