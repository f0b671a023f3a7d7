#pragma once

#include "csrbf/approx/fit_options.hpp"
#include "csrbf/core/field.hpp"

#include <memory>
#include <vector>

namespace csrbf {

/// A function fitted to samples: one field per component of their values.
template <int Dim>
struct Fit {
  std::vector<std::shared_ptr<const Field<Dim>>> components;
  /// Variance of the difference between a sample of mean weight and the component: the error of the function and the
  /// noise of the values together. For interpolate that of kriging (see KrigingVariance), 0 at samples without noise
  /// and growing between them; for partition-of-unity from local leave-one-out errors (see local_variance), outside the
  /// box growing with the distance as the values differ. Empty for the other methods, for interpolation of more than
  /// 4000 samples, and where there are too few samples to estimate it.
  std::vector<std::shared_ptr<const Field<Dim>>> variances = {};
  double variance_unit = 1;  ///< variances are in its square, which keeps those of huge and tiny values finite
  FitReport report = {};
  /// The samples' points, or some of them where the model is much smaller; null in older models.
  std::shared_ptr<const Points<Dim>> places = {};
};

}  // namespace csrbf
