#pragma once

#include "csrbf/approx/unity/partition_of_unity.hpp"

#include <memory>
#include <vector>

namespace csrbf {

/// Local variance of the prediction errors of a partition of unity, one field per component: the mean square of
/// leave-one-out errors (a sample against the local fit without it) of the surrounding patches, blended like the local
/// functions, weighted. It includes the noise of the values. It does not fall to 0 at the samples, and where the
/// function is hardest to fit, or the samples end, the errors of a patch may be larger than those around it: in trials,
/// 90 to 97 % of the errors were below 1.96 standard deviations for exact data, 94 to 95 % for noisy data.
///
/// From at most about 1000 patches spread over the cover, fewer where they are large, so its time hardly grows with
/// their number. `samples`: those that the fit was made from. Outside the cover: the value at the nearest point.
/// Where the nearest 48 errors are nothing, as values are constant there, it is the mean of all over 48: the next one
/// may not be, as on a coast. Where a tenth of the samples and more have another at less than .03 of the distance of
/// their neighbours, errors are those of samples without these, which then costs O(n log n) more.
template <int Dim>
std::vector<std::shared_ptr<const Field<Dim>>> local_variance(const Samples<Dim>& samples,
                                                              const PartitionOfUnityFit<Dim>& fit);

/// Squares of prediction errors at points as fields, one per component: the means of the nearest 48, weighted and
/// blended; `least` where these are nothing. `squares`: components x points, times their weights, which are 1 if there
/// are none.
template <int Dim>
std::vector<std::shared_ptr<const Field<Dim>>> local_means(const Points<Dim>& points, const Eigen::MatrixXd& squares,
                                                           const Eigen::VectorXd& weights = {},
                                                           const Eigen::VectorXd& least = {});

}  // namespace csrbf
