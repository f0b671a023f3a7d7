#pragma once

#include "csrbf/approx/levels/level_fit.hpp"
#include "csrbf/approx/samples/samples.hpp"

#include <string>

namespace csrbf {

/// Centres, and the scales of their supports.
template <int Dim>
struct BudgetCenters {
  std::vector<Index> ids;  ///< indices of the points, in the order of farthest point sampling
  Eigen::VectorXd scales;  ///< radii of the smallest balls about the centres that cover their bounded Voronoi cells
};

struct FixedBudgetOptions {
  std::string kernel = "wendland-c2";    ///< compactly supported
  Index centers = 0;                     ///< the budget; 0: a tenth of the samples
  double support = 4;                    ///< support radius in scales of the centre, above 1
  std::optional<double> lambda0 = 1e-6;  ///< regularisation, see RidgeOptions::lambda0; unset: chosen from the data
  Progress progress = {};                ///< stages "farthest points", "voronoi cells", "choose smoothing", "solve"
};

/// Farthest points and the scales of their Voronoi cells, bounded by the box of the points (thesis Algorithm 2). Cells
/// are exact in up to four dimensions and discrete beyond, where empty ones get the distance to the nearest centre.
template <int Dim>
BudgetCenters<Dim> budget_centers(const PointsRef<Dim>& points, Index count, const Progress& progress = {});

/// Approximates with a given number of centres (thesis section 3.2): farthest points of the samples. Supports are
/// proportional to the size of the bounded Voronoi cells (eq. 3.6), so that they cover the box. Coefficients come from
/// regularised least squares, since matrices with a support per centre may be singular. Duplicates are merged.
///
/// Supports that shrink with the cells bound the cost per centre but lose the order of convergence: beyond some hundred
/// centres the error falls slowly or not at all, as in every stationary scheme. If accuracy matters more than the
/// number of centres, use multilevel() or error_bounded().
///
/// Throws InvalidInput for invalid samples, a negative budget, support <= 1 (the supports would leave gaps) and kernels
/// without compact support; SolverFailure if the least squares problem cannot be solved; Cancelled.
template <int Dim>
LevelFit<Dim> fixed_budget(const Samples<Dim>& samples, const FixedBudgetOptions& options = {});

}  // namespace csrbf
