#pragma once

#include "csrbf/approx/global/interpolate.hpp"
#include "csrbf/approx/global/kriging_variance.hpp"

#include <vector>

namespace csrbf {

/// How errors of one system outgrow what its covariance says of them where samples are on one side only: a likelihood
/// hears of errors between the samples, and smooth functions that are no random functions of the covariance are further
/// off beyond. Caps, the outermost tenth to third of samples along some directions, are left out and predicted from the
/// others; with the growth 95 % of these errors are within their intervals. One for each component; none (1) where
/// too few samples, or their noise, do not tell. Of kernels that are not smooth, the least is what they say of the
/// closest samples: nothing tells noise from a step of the function between these.
///
/// `options`: kernel, support, smoothing and degree of the system; `sigma2`: its variance by component. From at most
/// 200 of the samples: O(n^3) for six systems of these.
template <int Dim>
std::vector<ErrorGrowth> left_out_caps(const Samples<Dim>& samples, const InterpolateOptions& options,
                                       const Eigen::VectorXd& sigma2);

}  // namespace csrbf
