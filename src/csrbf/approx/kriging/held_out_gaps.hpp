#pragma once

#include "csrbf/approx/kriging/covariance.hpp"
#include "csrbf/core/types.hpp"

namespace csrbf {

struct HeldOutChoice {
  Covariance covariance;
  bool is_linear;  ///< its variogram, over the extent of the samples
};

/// What covariances are worth in gaps between samples, which their likelihood at the distances of samples does not
/// tell: samples are predicted from others that lie about them as the samples that there are lie about points in gaps.
template <int Dim>
class HeldOutGaps {
 public:
  /// `gaps`: points in gaps. For each of them a few samples are tried in its place. All must outlive it.
  HeldOutGaps(const Samples<Dim>& samples, const ThinnedLevels<Dim>& levels, const Points<Dim>& gaps);

  /// Whether there are too few to tell anything.
  [[nodiscard]] bool empty() const { return std::ssize(cases_) < fewest_cases; }

  /// The covariance to fill gaps by, with the size of its errors: one that is rough and correlated over all samples (an
  /// intrinsic random function, with a linear variogram), unless a likely one predicts significantly better, by their
  /// mean continuous ranked probability scores (Gneiting and Raftery 2007). O(k^3) for each case and covariance, with k
  /// samples around a gap.
  [[nodiscard]] HeldOutChoice choose(const Covariance& likely) const;

 private:
  static constexpr Index fewest_cases = 40;  // chosen by hand
  struct Case {
    Index target;               // the sample that is predicted
    std::vector<Index> around;  // from these
  };
  struct Predictions {
    Eigen::MatrixXd errors;  // of the targets, by component
    Eigen::VectorXd shares;  // their expected squares, over sigma^2
    Eigen::MatrixXd scales;  // sigma^2 of the samples around, by component
    [[nodiscard]] Eigen::VectorXd variances(const Covariance& covariance, Index component) const;
  };
  [[nodiscard]] Predictions predict(const Covariance& covariance) const;
  // Chooses the parts of the covariance that are about the size of errors.
  void calibrate(Covariance& covariance, const Predictions& p) const;
  [[nodiscard]] Eigen::VectorXd scores(const Covariance& covariance, const Predictions& p) const;

  const Samples<Dim>& samples_;
  const ThinnedLevels<Dim>& levels_;
  std::vector<Case> cases_;
  Eigen::VectorXd deviations_;  // of the values
};

}  // namespace csrbf
