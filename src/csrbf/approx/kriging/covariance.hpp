#pragma once

#include "csrbf/approx/global/axis_covariance.hpp"
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
  // What errors of predictions are beside those expected by the covariance:
  double local = 0.75;             ///< power of the sigma^2 of a neighbourhood, that of all samples has the rest
  double growth = 1;               ///< power of the share of sigma^2 that is expected
  Eigen::VectorXd inflation = {};  ///< factor, one per component; empty: 1
};

/// That of points in the lengths of a covariance (in_lengths()), with sigma^2 = 1 and a nugget above rounding.
template <int Dim>
Covariance in_lengths(const AxisCovariance<Dim>& covariance, Index components) {
  constexpr double rounding = 1e-14;
  return {.kernel = covariance.kernel,
          .nugget = std::max(covariance.nugget, rounding),
          .degree = covariance.degree,
          .sigma2 = Eigen::VectorXd::Ones(components)};
}

/// Expected square of the error of a prediction: `share` by the covariance, over sigma^2; `scale`: sigma^2 of the
/// samples around.
double prediction_variance(const Covariance& covariance, Index component, double share, double scale);

/// The same with the nugget of largest restricted likelihood for blocks of nearest samples, which alone can tell noise
/// from roughness.
template <int Dim>
Covariance with_nearby_nugget(const Samples<Dim>& samples, const ThinnedLevels<Dim>& levels, Covariance covariance);

/// The covariance of largest restricted likelihood (Patterson and Thompson 1971), for blocks of neighbouring samples at
/// all scales: a composite likelihood, whose cost hardly grows with the number of samples. Kernels from rough to
/// smooth: powered-exponential (0.7), matern-c0, -c2, -c4, -c6 and gaussian; all components have the same. A linear
/// trend where the kernel is rough. `levels`: of the points.
template <int Dim>
Covariance estimate_covariance(const Samples<Dim>& samples, const ThinnedLevels<Dim>& levels);

}  // namespace csrbf
