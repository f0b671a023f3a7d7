#pragma once

#include "csrbf/approx/samples/merge_duplicates.hpp"
#include "csrbf/kernels/kernel.hpp"

#include <optional>

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
};

/// Points turned to the axes of a covariance, in units of its lengths.
template <int Dim>
Points<Dim> in_lengths(const PointsRef<Dim>& points, const AxisCovariance<Dim>& covariance) {
  Points<Dim> result = points;
  if (covariance.axes) result = covariance.axes->transpose() * points;
  result.array().colwise() /= covariance.lengths.array();
  return result;
}

/// The covariance of largest restricted likelihood, from at most some hundreds of the samples; kernels from rough to
/// smooth are compared by likelihood and leave-one-out errors. Where values change along other directions than the
/// coordinates (slope_directions()), these are axes if that is better. `one_length`: for all axes. None for fewer than
/// twice as many samples as it has parameters, and for values without any variation. `samples`: distinct points with
/// positive weights.
template <int Dim>
std::optional<AxisCovariance<Dim>> estimate_axis_covariance(const Samples<Dim>& samples, const Replicates& replicates,
                                                            bool one_length = false);

/// Mean absolute error of samples predicted from all others by this covariance, over all components: of all, or of some
/// hundreds among their neighbours.
template <int Dim>
double left_out_error(const Samples<Dim>& samples, const AxisCovariance<Dim>& covariance);

}  // namespace csrbf
