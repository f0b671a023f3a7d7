#pragma once

#include "csrbf/approx/fit_by_method.hpp"
#include "csrbf/approx/global/axis_covariance.hpp"

namespace csrbf {

/// What fit() decides by the samples before it fits them.
template <int Dim>
struct ModelChoice {
  FitMethod method;
  /// Of one system of all samples, each as likely as its weight; empty: none is to be learned, or can be.
  std::vector<AxisCovariance<Dim>> covariances = {};
  Point<Dim> scales;  ///< what coordinates are divided by, those along the axes of the covariances
  Extrapolation extrapolation;
  /// Samples that the one system is of, spread over the others; empty: all.
  std::vector<Index> thinned = {};
  bool lines = false;  ///< whether many samples lie on lines

  /// What one covariance takes its coordinates to, in its shortest length; unset: the scales alone say it.
  [[nodiscard]] std::optional<Eigen::Matrix<double, Dim, Dim>> map() const;
};

/// `samples`: as they will be fitted, at distinct points unless the method keeps duplicates. A method that is given
/// stays, and so does the way of extrapolation. `may_thin`: whether one system may be of some samples only.
template <int Dim>
ModelChoice<Dim> choose_model(const Samples<Dim>& samples, const Replicates& replicates, const FitOptions& options,
                              FitMethod method, bool may_thin = true);

}  // namespace csrbf
