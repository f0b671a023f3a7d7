#pragma once

#include "csrbf/approx/levels/level_fit.hpp"
#include "csrbf/approx/samples/samples.hpp"

#include <string>

namespace csrbf {

struct LeastSquaresOptions {
  std::string kernel = "wendland-c2";      ///< compactly supported
  Index centers = 0;                       ///< number of farthest points of the samples; 0: a quarter of them
  double support = 0;                      ///< common radius, in spacings of the centres; 0: 1 + 8 / Dim
  LevelSolve penalty = LevelSolve::ridge;  ///< ridge or native; interpolation is refused
  std::optional<double> lambda0 = 1e-8;    ///< regularisation, see RidgeOptions::lambda0; unset: chosen from the data
  Progress progress = {};                  ///< stages "farthest points", "choose smoothing", "solve"
};

/// Regularised least squares with fewer centres than samples (thesis sections 1.1.2 and 2.5): minimises
/// sum_k w_k |f(p_k) - s_k|^2 + lambda |c|^2 or + lambda c^T A c for f = mean + sum_j c_j phi(|p - c_j| / sigma).
/// Duplicates are merged. About O(N (centres per support)^2) for the equations, plus a sparse Cholesky factorisation.
///
/// Throws InvalidInput for invalid samples, kernels without compact support and negative options; SolverFailure if the
/// least squares problem cannot be solved; Cancelled.
template <int Dim>
LevelFit<Dim> least_squares(const Samples<Dim>& samples, const LeastSquaresOptions& options = {});

/// The same with the given centres, which need not be samples.
template <int Dim>
LevelFit<Dim> least_squares(const Samples<Dim>& samples, const PointsRef<Dim>& centers,
                            const LeastSquaresOptions& options = {});

}  // namespace csrbf
