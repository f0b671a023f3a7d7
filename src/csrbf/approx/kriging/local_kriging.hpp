#pragma once

#include "csrbf/approx/kriging/covariance.hpp"
#include "csrbf/approx/unity/local_models.hpp"
#include "csrbf/linalg/decompositions.hpp"

namespace csrbf {

/// The best linear unbiased prediction (universal kriging; Matheron 1969) from samples around a point, dense near it
/// and sparse far from it: reliable also in gaps between samples that are much wider than their distances.
/// What is the same in every dimension.
class KrigingSystem {
 public:
  /// Prediction at x, one value per component.
  [[nodiscard]] Eigen::VectorXd value(const Eigen::Ref<const Eigen::VectorXd>& x) const;

  /// Variance of the difference between a sample of mean weight at x and its prediction, one per component; its size
  /// follows the residuals of the samples of the patch. O(n^2).
  [[nodiscard]] Eigen::VectorXd variance(const Eigen::Ref<const Eigen::VectorXd>& x) const;
  /// The same over sigma^2.
  [[nodiscard]] double share(const Eigen::Ref<const Eigen::VectorXd>& x) const;

  /// sigma^2 by the residuals of the samples of the patch alone: the geometric mean of
  /// that of all and that of the nearest ones.
  [[nodiscard]] const Eigen::VectorXd& scale() const { return scale_; }

  /// Whether values, one per component, may be expected among the samples of the patch: between those of the samples
  /// or, beyond, within a range of all of these.
  [[nodiscard]] bool is_plausible(const Eigen::VectorXd& values) const {
    return ((values - middle_).array().abs() <= 1.5 * range_.array()).all();
  }

 protected:
  /// `nearest`: how many samples around the middle tell the scale there.
  KrigingSystem(const SampleView& samples, const Covariance& covariance, const Eigen::VectorXd& center,
                const std::vector<Index>& chosen, Index nearest);

  Covariance covariance_;
  Eigen::VectorXd center_;
  Eigen::MatrixXd q_;  // the samples from the middle, in lengths
  Eigen::MatrixXd alpha_, beta_;

 private:
  [[nodiscard]] Eigen::RowVectorXd trend(const Eigen::VectorXd& q) const;
  [[nodiscard]] Eigen::VectorXd near_scale(const Eigen::MatrixXd& values, const Eigen::VectorXd& inverse_weights,
                                           Index nearest) const;

  Eigen::LLT<Eigen::MatrixXd> llt_;
  Eigen::MatrixXd white_trend_;
  Eigen::LDLT<Eigen::MatrixXd> information_;
  Eigen::VectorXd scale_;
  Eigen::VectorXd middle_, range_;  // of the values of the samples
  double nugget_ = 0;
};

template <int Dim>
class KrigingPatch : public KrigingSystem {
 public:
  /// `chosen`: indices of the samples. The nugget must be positive: it grows until the matrix has a factor. O(n^3 / 3).
  KrigingPatch(const Samples<Dim>& samples, const Covariance& covariance, const Point<Dim>& center,
               const std::vector<Index>& chosen);

  /// Writes the predictor to model `i`; `models` has room for all samples.
  void store(LocalModels<Dim>& models, Index i) const;
};

/// The samples that a patch around x is made of.
template <int Dim>
std::vector<Index> samples_around(const ThinnedLevels<Dim>& levels, const Point<Dim>& x);

/// Patches around any point.
template <int Dim>
class LocalKriging {
 public:
  /// `samples`: with weights of mean 1, or none; must outlive it. `gaps`: points in the gaps to be filled, in
  /// which the covariance is to predict well (see HeldOutGaps).
  LocalKriging(const Samples<Dim>& samples, const Points<Dim>& gaps);

  [[nodiscard]] const Covariance& covariance() const { return covariance_; }
  /// Whether it is that of a linear variogram, as HeldOutGaps prefers.
  [[nodiscard]] bool is_linear() const { return is_linear_; }
  [[nodiscard]] KrigingPatch<Dim> patch(const Point<Dim>& center) const;
  /// The samples that it is made of.
  [[nodiscard]] std::vector<Index> around(const Point<Dim>& center) const;
  /// Models with room for `count` patches.
  [[nodiscard]] LocalModels<Dim> models(Index count) const;

 private:
  const Samples<Dim>& samples_;
  ThinnedLevels<Dim> levels_;
  Covariance covariance_;
  bool is_linear_ = false;
};

}  // namespace csrbf
