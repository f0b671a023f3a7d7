#pragma once

#include "csrbf/approx/levels/level_fit.hpp"
#include "csrbf/approx/samples/samples.hpp"

#include <string>

namespace csrbf {

template <int Dim>
class LevelBuilder;

struct ErrorBoundedOptions {
  std::string kernel = "wendland-c2";    ///< compactly supported
  std::optional<double> tolerance = {};  ///< largest error at any sample, in units of the values; default: 1 % of
                                         ///< their range
  Index centers = 0;                     ///< budget of the first level; 0: a fiftieth of the samples
  double support = 3;                    ///< first level: radius in scales of the Voronoi cells; others: in separation
                                         ///< distances of the centres. Above 1
  double reduction = 0.5;                ///< of the separation distance from level to level; in (0, 1)
  std::optional<double> lambda0 = 1e-6;  ///< regularisation (see sparse_least_squares); empty: chosen from the data
  Index max_levels = 30;                 ///< before the last level, which removes the remaining errors
  Progress progress = {};                ///< stages of fixed_budget and "levels"
};

/// Approximation within a tolerance at every sample (thesis section 3.3): the first level is fixed_budget; each further
/// one adds farthest points until they are `reduction` times as far apart (thesis: mu), keeps those where the error is
/// above the tolerance and fits the residual with narrower supports (eq. 3.13, with the separation distance of all
/// farthest points). Samples still above the tolerance at the end get a basis function of their own that vanishes at
/// all other samples: so **the bound always holds, at every sample**, up to rounding (1e-12 of the range).
///
/// Several samples at one point are replaced by the midpoint of their range; the bound holds for each of them.
///
/// Throws InvalidInput for samples or options that are not valid; SolverFailure when samples at the same point differ
/// by more than twice the tolerance, since no function is close to both, and when the tolerance is below the last digit
/// of the largest value.
template <int Dim>
LevelFit<Dim> error_bounded(const Samples<Dim>& samples, const ErrorBoundedOptions& options = {});

/// The tolerance in force: the given one or 1 % of the range. Throws InvalidInput (in the name of `function`) when it
/// is negative or not finite and SolverFailure as error_bounded.
template <int Dim>
double checked_tolerance(const LevelBuilder<Dim>& builder, std::optional<double> tolerance, const char* function);

}  // namespace csrbf
