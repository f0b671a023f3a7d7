#pragma once

#include "csrbf/approx/samples/merge_duplicates.hpp"
#include "csrbf/kernels/kernel.hpp"

#include <optional>
#include <vector>

namespace csrbf {

/// A covariance with one length for every axis, see RestrictedLikelihood. Axes that the values do not depend on have
/// long ones.
template <int Dim>
struct AxisCovariance {
  Kernel kernel;
  Point<Dim> lengths;
  double nugget = 0;  ///< variance of the noise of a sample of weight 1 over sigma^2; 0 where only rounding bounds it
  int degree = 0;     ///< of the trend
  /// The axes that the lengths are along, its columns; unset: those of the coordinates.
  std::optional<Eigen::Matrix<double, Dim, Dim>> axes = {};
  double weight = 1;  ///< of several that are likely; their sum is 1
};

template <int Dim>
struct CovarianceEstimate {
  std::optional<AxisCovariance<Dim>> best = {};
  /// Up to twelve that few samples leave open, each as likely as its weight (Kennedy and O'Hagan 2001): kernels,
  /// lengths and nuggets; empty where the best one will do.
  std::vector<AxisCovariance<Dim>> likely = {};
};

/// The same for code that would be the same in every dimension.
template <int Dim>
AxisCovariance<Eigen::Dynamic> of_any_dimension(const AxisCovariance<Dim>& covariance) {
  AxisCovariance<Eigen::Dynamic> result{covariance.kernel, covariance.lengths, covariance.nugget, covariance.degree};
  if (covariance.axes) result.axes = *covariance.axes;
  result.weight = covariance.weight;
  return result;
}

/// Points turned to the axes of a covariance, in units of its lengths.
template <int Dim>
Points<Dim> in_lengths(const PointsRef<Dim>& points, const AxisCovariance<Dim>& covariance) {
  Points<Dim> result = points;
  if (covariance.axes) result = covariance.axes->transpose() * points;
  result.array().colwise() /= covariance.lengths.array();
  return result;
}

/// The covariance of largest restricted likelihood, with a prior of its lengths, from at most some hundreds of the
/// samples; kernels from rough to smooth are compared by likelihood and leave-one-out errors. Where values change along
/// other directions than the coordinates (slope_directions()), these are axes if that is better. `one_length`: for all
/// axes. None for values without any variation, and for fewer than `fewest_more` samples more than it has parameters,
/// which are the lengths and the noise. `samples`: distinct points with positive weights.
template <int Dim>
CovarianceEstimate<Dim> estimate_axis_covariance(const Samples<Dim>& samples, const Replicates& replicates,
                                                 bool one_length = false, Index fewest_more = 3);

/// Mean absolute error of samples predicted from all others by this covariance, over all components: of all, or of some
/// hundreds among their neighbours.
template <int Dim>
double left_out_error(const Samples<Dim>& samples, const AxisCovariance<Dim>& covariance);

}  // namespace csrbf
