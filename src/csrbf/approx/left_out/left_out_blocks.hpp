#pragma once

#include "csrbf/approx/global/interpolate.hpp"
#include "csrbf/approx/global/kriging_variance.hpp"

#include <vector>

namespace csrbf {

/// How errors of one system outgrow what its covariance says of them in gaps and beyond the samples: a likelihood hears
/// of errors between samples, and smooth functions that are no random functions of the covariance are further off where
/// samples are far. Blocks of samples, beyond planes (not on a line) and in balls, from a fiftieth to a third of all,
/// are left out and predicted from the others; with the growth 95 % of these errors are within their intervals. One for
/// each component; none (1) where too few samples, or their noise, do not tell. Of kernels that are not smooth, the
/// least is what they say of the closest samples: nothing tells noise from a step of the function between these.
///
/// `options`: kernel, which is positive definite, support, smoothing and degree of the system; `sigma2`: its variance
/// by component. From 400 of the samples, two in five of more than 1000, 800 of more than 2000: O(n^3) for six systems
/// of these, as blocks within each other need one factor.
template <int Dim>
std::vector<ErrorGrowth> left_out_blocks(const Samples<Dim>& samples, const InterpolateOptions& options,
                                         const Eigen::VectorXd& sigma2);

}  // namespace csrbf
