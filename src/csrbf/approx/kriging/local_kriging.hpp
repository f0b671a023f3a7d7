#pragma once

#include "csrbf/approx/kriging/covariance.hpp"
#include "csrbf/approx/unity/local_models.hpp"

#include <Eigen/Cholesky>

namespace csrbf {

/// The best linear unbiased prediction (universal kriging; Matheron 1969) from samples around a point, dense near it
/// and sparse far from it: reliable also in gaps between samples that are much wider than their distances.
template <int Dim>
class KrigingPatch {
 public:
  /// `chosen`: indices of the samples. O(n^3 / 3).
  KrigingPatch(const Samples<Dim>& samples, const Covariance& covariance, const Point<Dim>& center,
               const std::vector<Index>& chosen);

  /// Variance of the difference between a sample of mean weight at x and its prediction, one per component; its size
  /// follows the residuals of the samples of the patch. O(n^2).
  [[nodiscard]] Eigen::VectorXd variance(const Point<Dim>& x) const;

  /// Writes the predictor to model `i`; `models` has room for all samples.
  void store(LocalModels<Dim>& models, Index i) const;

 private:
  [[nodiscard]] Eigen::RowVectorXd trend(const Point<Dim>& q) const;

  Covariance covariance_;
  Point<Dim> center_;
  Points<Dim> q_;  // the samples from the middle, in lengths
  Eigen::LLT<Eigen::MatrixXd> llt_;
  Eigen::MatrixXd white_trend_;
  Eigen::LDLT<Eigen::MatrixXd> information_;
  Eigen::MatrixXd alpha_, beta_;
  Eigen::VectorXd sigma2_;
};

/// Patches around any point.
template <int Dim>
class LocalKriging {
 public:
  /// `samples`: with weights of mean 1, or none; must outlive it.
  explicit LocalKriging(const Samples<Dim>& samples);

  [[nodiscard]] const Covariance& covariance() const { return covariance_; }
  [[nodiscard]] KrigingPatch<Dim> patch(const Point<Dim>& center) const;
  /// Models with room for `count` patches.
  [[nodiscard]] LocalModels<Dim> models(Index count) const;

 private:
  const Samples<Dim>& samples_;
  ThinnedLevels<Dim> levels_;
  Covariance covariance_;
};

}  // namespace csrbf
