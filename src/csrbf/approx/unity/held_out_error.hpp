#pragma once

#include "csrbf/approx/samples/samples.hpp"
#include "csrbf/approx/unity/local_fit.hpp"

#include <optional>
#include <vector>

namespace csrbf {

/// Errors of a fit at samples that it was not fitted to.
struct HeldOutError {
  double mean = 0;  ///< absolute, of all components
  double rmse = 0;

  HeldOutError() = default;
  explicit HeldOutError(const Eigen::MatrixXd& errors)
      : mean(errors.cwiseAbs().mean()), rmse(errors.stableNorm() / std::sqrt(static_cast<double>(errors.size()))) {}
};

/// Numbers of samples, ascending: those a fit to the others is asked for, and the others.
struct HeldOutRows {
  std::vector<Index> asked, others;
};

/// Samples in gaps as wide as those between lines, tracks or clusters. A sample left out alone is predicted by its
/// neighbours there, which says nothing of places between these. Gaps around random places are moved to the nearest
/// samples, where all within are left out, a fifth of all at most, and a few are asked. None where samples are spread
/// evenly, so that single ones will do, where few can be asked, and but in the plane and in space. O(n log n).
template <int Dim>
std::optional<HeldOutRows> held_out_in_gaps(const Points<Dim>& points);

/// Holds out some thousand samples spread over all, at most a tenth of them, or those told. Unlike leaving samples out
/// of single patches this measures the blend of patches, which for small ones is much better than each of them. The
/// weights of samples must have the mean 1. Costs a fit of the patches around the held-out samples.
template <int Dim>
class HeldOutSamples {
 public:
  /// `fold`: less than folds() of them.
  explicit HeldOutSamples(const Samples<Dim>& samples, Index fold = 0);
  HeldOutSamples(const Samples<Dim>& samples, const HeldOutRows& rows);

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
