#pragma once

#include "csrbf/approx/kriging/thinned_levels.hpp"
#include "csrbf/approx/samples/samples.hpp"
#include "csrbf/kernels/kernel.hpp"

namespace csrbf {

/// Samples as values of a random function: a polynomial trend plus a part of mean 0 and covariance sigma^2 phi(|x - y|
/// / length), plus noise of variance sigma^2 nugget / weight.
struct Covariance {
  Kernel kernel;
  double length = 1;
  double nugget = 0;
  int degree = 0;          ///< of the trend
  Eigen::VectorXd sigma2;  ///< one per component of the values
};

/// The covariance of largest restricted likelihood (Patterson and Thompson 1971), for blocks of neighbouring samples at
/// all scales: a composite likelihood, whose cost hardly grows with the number of samples. Kernels from rough to
/// smooth: powered-exponential (0.7), matern-c0, -c2, -c4, -c6 and gaussian; all components have the same. A linear
/// trend where it predicts samples of the blocks better from the others. `levels`: of the points.
template <int Dim>
Covariance estimate_covariance(const Samples<Dim>& samples, const ThinnedLevels<Dim>& levels);

}  // namespace csrbf
