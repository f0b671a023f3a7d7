#pragma once

#include "csrbf/approx/levels/level_fit.hpp"
#include "csrbf/approx/samples/samples.hpp"

#include <string>

namespace csrbf {

struct MultilevelOptions {
  std::string kernel = "wendland-c2";  ///< compactly supported
  double support = 0;                  ///< radius, in separation distances of the centres of the level; 0: 1 + 8 / Dim
  Index coarsest = 0;                  ///< number of centres of the first level; 0: 2 * 3^Dim
  Index centers = 0;                   ///< number of centres of the last level; 0: all samples
  Index max_levels = 20;
  double tolerance = 0;                          ///< stop when all errors are at most this, in the unit of the values
  LevelSolve solve = LevelSolve::interpolation;  ///< how every level is fitted to the residual
  std::optional<double> lambda0 = 1e-8;          ///< of the least squares; unset: chosen from the data
  Progress progress = {};                        ///< stages "farthest points", "levels", "solve"
};

/// Multilevel approximation (Floater and Iske 1996; thesis eqs. 2.17-2.19): nested sets of farthest points, each about
/// half as far apart as the one before. Every level interpolates the residual of those before at its centres, or fits
/// it at all samples, with supports proportional to the separation distance. So all matrices are sparse and well
/// conditioned, and the error still falls as for wide supports; with a single narrow support it would not.
///
/// With interpolation and all samples as centres f interpolates the data, unless max_levels is too small for the
/// variation of the sampling density. `converged` says whether the tolerance was met. O(N log N) without the solver.
///
/// Throws InvalidInput for invalid samples, kernels without compact support and negative options; SolverFailure if a
/// level cannot be solved; Cancelled.
template <int Dim>
LevelFit<Dim> multilevel(const Samples<Dim>& samples, const MultilevelOptions& options = {});

}  // namespace csrbf
