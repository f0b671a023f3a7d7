#pragma once

#include "csrbf/core/types.hpp"

#include <string>

namespace csrbf {

/// How values depend on covariates: linearly, for k values and q covariates.
struct DriftEstimate {
  Eigen::MatrixXd beta;           ///< q x k
  Eigen::MatrixXd unit_variance;  ///< q x q: the covariance of beta over sigma^2
  Eigen::VectorXd sigma2;         ///< k, of the residuals

  [[nodiscard]] Eigen::MatrixXd covariance(Index component) const { return sigma2[component] * unit_variance; }
};

/// Generalised least squares for values = g(points) + beta covariates: g counts as a random function with the
/// covariance that is likeliest for the residuals (see estimate_covariance()), found in turns with beta. Exact up to
/// 1000 samples; of more, blocks of 100 neighbours each count as independent of each other.
///
/// `points` d x n, in units in which distances may be compared, `values` n x k, `covariates` n x q, `weights` n or
/// empty, `loss` as in FitOptions: gross errors do not count. Throws InvalidInput when there are too few samples, and
/// when the covariates do not vary independently.
DriftEstimate estimate_drift(const Eigen::MatrixXd& points, const Eigen::MatrixXd& values,
                             const Eigen::MatrixXd& covariates, const Eigen::VectorXd& weights,
                             const std::string& loss);

}  // namespace csrbf
