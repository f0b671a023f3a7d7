#pragma once

#include "csrbf/approx/kriging/grown_variance.hpp"
#include "csrbf/approx/kriging/patch_errors.hpp"

#include <memory>
#include <vector>

namespace csrbf {

/// How errors of the local functions of a partition of unity grow with the distance to the samples, where these are
/// sparser than leave-one-out errors tell but no gap that another function should fill: learned from samples that are
/// left out together with all in a ball around them. In one to three dimensions.
template <int Dim>
class DistanceGrowth {
 public:
  /// `variances`: mean squares of leave-one-out errors, see local_variance. O(n^3) for each of some hundred patches of
  /// n samples; patches of very many samples are taken not to notice such balls.
  DistanceGrowth(const Samples<Dim>& samples, const PartitionOfUnityFit<Dim>& fit,
                 const std::vector<std::shared_ptr<const Field<Dim>>>& variances);

  /// Of variances, by component, at a distance to the nearest sample in distances of samples; at least 1.
  [[nodiscard]] Eigen::VectorXd factor(double distance) const;

  /// The variances, by component, as they grow; empty where they do not noticeably anywhere. O(n).
  [[nodiscard]] std::vector<std::shared_ptr<const Field<Dim>>> grown(
      const PatchErrors<Dim>& patches, const std::vector<std::shared_ptr<const Field<Dim>>>& variances) const;

 private:
  void learn(const Points<Dim>& points, const Eigen::MatrixXd& squares, const Eigen::VectorXd& distances,
             const std::vector<std::shared_ptr<const Field<Dim>>>& variances);

  const Cover<Dim>& cover_;
  std::vector<GrowthWithDistance> growth_;  // by component
  double begin_;                            // distance from which on variances grow noticeably
};

}  // namespace csrbf
