#pragma once

#include "csrbf/approx/samples/samples.hpp"
#include "csrbf/core/progress.hpp"
#include "csrbf/kernels/kernel.hpp"

namespace csrbf {

struct SmoothingOfManyOptions {
  double start = 0;        ///< > 0: kept where more does not matter
  double left_out = 0;     ///< > 0: about the root mean square of the leave-one-out errors, in the unit of the values
  Progress progress = {};  ///< stage "choose"
};

/// The lambda of (A + lambda W^-1) alpha + G pi = s, G^T alpha = 0 with the smallest error of generalised
/// cross-validation (Craven and Wahba 1979) over all n samples, for systems that only solve_iteratively() solves:
///
///     GCV = mean_k w_k (s_k - f_k)^2 / (1 - tr S / n)^2 = mean_k alpha_k^2 / w_k / (u^T C u / n)^2,
///
/// where C s = alpha and u are random signs over the roots of the weights, for the trace of W^-1 C (Girard 1989); the
/// same ones for all lambda, so that GCV is smooth. Components count in units of their standard deviations.
///
/// The range is searched on a random subset of 5000 samples, then by three or more systems of all of them, whose
/// residuals are a fiftieth of the errors: about five times the cost of the fit. Where lambda does not matter, as for
/// values without noise, it is `start`.
///
/// `samples`: distinct points, in the coordinates in which distances are those of the kernel; weights of mean 1. `G`: n
/// x q, of full rank.
template <int Dim>
double smoothing_of_many(const Samples<Dim>& samples, const Kernel& kernel, double support, const Eigen::MatrixXd& G,
                         const SmoothingOfManyOptions& options);

}  // namespace csrbf
