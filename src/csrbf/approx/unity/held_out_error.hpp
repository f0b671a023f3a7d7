#pragma once

#include "csrbf/approx/samples/samples.hpp"
#include "csrbf/approx/unity/local_fit.hpp"

namespace csrbf {

/// Errors of a fit at samples that it was not fitted to.
struct HeldOutError {
  double mean = 0;  ///< absolute, of all components
  double rmse = 0;

  HeldOutError() = default;
  explicit HeldOutError(const Eigen::MatrixXd& errors)
      : mean(errors.cwiseAbs().mean()), rmse(errors.stableNorm() / std::sqrt(static_cast<double>(errors.size()))) {}
};

/// Holds out some thousand samples spread over all, at most a tenth of them. Unlike leaving samples out of single
/// patches this measures the blend of patches, which for small ones is much better than each of them. The weights of
/// samples must have the mean 1. Costs a fit of the patches around the held-out samples.
template <int Dim>
class HeldOutSamples {
 public:
  /// `fold`: less than folds() of them.
  explicit HeldOutSamples(const Samples<Dim>& samples, Index fold = 0);

  /// Folds of n samples, from 0 on, that hold out some thousand together, each another part.
  [[nodiscard]] static Index folds(Index n);

  /// What a partition of unity of the other samples misses them by: samples x components.
  [[nodiscard]] Eigen::MatrixXd errors(const LocalOptions& options) const;

  /// The same for any fit to the other samples, with one field per component.
  [[nodiscard]] Eigen::MatrixXd errors(const std::vector<std::shared_ptr<const Field<Dim>>>& fields) const;
  [[nodiscard]] const Samples<Dim>& others() const { return kept_; }
  [[nodiscard]] const Samples<Dim>& held_out() const { return held_out_; }

 private:
  Samples<Dim> kept_, held_out_;
};

}  // namespace csrbf
