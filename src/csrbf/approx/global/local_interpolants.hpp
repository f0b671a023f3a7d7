#pragma once

#include "csrbf/approx/global/rbf_system.hpp"
#include "csrbf/approx/samples/nearest_samples.hpp"

namespace csrbf {

/// Samples that are interpolated locally.
struct LocalInterpolants {
  const RbfBasis& basis;
  const NearestSamples& search;      ///< over `points`
  const Eigen::MatrixXd& points;     ///< d x n
  const Eigen::MatrixXd& values;     ///< k x n
  const Eigen::VectorXd& smoothing;  ///< n
  Index neighbors;                   ///< at most n

  /// Writes to `out` (k x m), for each of m points x (d x m), the value of the interpolant of its nearest samples; one
  /// system is solved for all points of the call with the same ones. Fastest when the points are close to each other.
  /// On the calling thread. Throws SolverFailure for singular systems.
  void evaluate(const Eigen::Ref<const Eigen::MatrixXd>& x, Eigen::Ref<Eigen::MatrixXd> out) const;
};

}  // namespace csrbf
