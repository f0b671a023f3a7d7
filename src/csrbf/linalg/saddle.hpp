#pragma once

#include "csrbf/linalg/ridge.hpp"

namespace csrbf {

struct SaddleOptions {
  double lambda = 0;             ///< >= 0; 0 interpolates
  Eigen::VectorXd weights = {};  ///< n, positive; empty: all 1
  bool leave_one_out = true;     ///< whether to compute the leave-one-out errors: doubles the cost

  /// For systems that are not positive definite to working precision, such as those of very smooth kernels with wide
  /// supports: the largest lambda to try instead (a jitter), in units of the mean diagonal entry of A; the smallest
  /// that works is used. 0: none.
  double largest_rescue = 0;
};

/// Solution of the interpolation or smoothing system of a (conditionally) positive definite kernel.
struct SaddleSolution {
  Eigen::MatrixXd alpha;          ///< n x C coefficients of the kernel
  Eigen::MatrixXd pi;             ///< Q x C coefficients of the polynomial
  Eigen::MatrixXd leave_one_out;  ///< n x C: s_k minus the value at point k of the fit to all other data, same lambda
  double condition = 1;           ///< estimated from the Cholesky factor: at least of this order
  double lambda = 0;              ///< that of the options, or the larger one that made the system positive definite
};

/// Solves (thesis eq. 2.13; D = diag(1 / weights))
///
///     [ A + lambda D   G ] [ alpha ]   [ s ]
///     [ G^T            0 ] [ pi    ] = [ 0 ]
///
/// for C right-hand sides s (n x C). A (n x n, lower triangle read) must be positive definite on the vectors orthogonal
/// to the columns of G (n x Q; no columns: everywhere). By a QR decomposition of G and the Cholesky factor of A on the
/// null space of G^T. The leave-one-out errors are alpha_k / C_kk with C the upper left block of the inverse (Rippa
/// 1999), exact with and without G; infinite where the other points do not determine the polynomial.
///
/// O(n^3 / 3), twice that with errors. Throws InvalidInput for sizes that do not match, entries that are not finite,
/// weights that are not positive, lambda < 0, and linearly dependent columns of G: the points lie on the zero set of a
/// polynomial. Throws SolverFailure when A + lambda D is not positive definite there to working precision.
SaddleSolution solve_saddle(const Eigen::Ref<const Eigen::MatrixXd>& A, const Eigen::Ref<const Eigen::MatrixXd>& G,
                            const Eigen::Ref<const Eigen::MatrixXd>& s, const SaddleOptions& options = {});

struct SmoothingOptions {
  LambdaCriterion criterion = LambdaCriterion::generalized_cross_validation;
  double smallest = 1e-14;       ///< lower end of the range of lambda over the mean eigenvalue of A on the null space
                                 ///< of G^T: interpolation up to rounding
  double largest = 1e4;          ///< upper end: nearly the polynomial alone
  Eigen::VectorXd weights = {};  ///< n, positive; empty: all 1
};

struct SmoothingChoice {
  double lambda = 0;           ///< for SaddleOptions
  double leave_one_out = 0;    ///< weighted root mean square of the leave-one-out errors with this lambda
  double gcv = 0;              ///< mean_k w_k (s_k - f_k)^2 / (trace(I - S) / n)^2 over all components
  double free_parameters = 0;  ///< trace of the hat matrix S: n interpolates, Q is the polynomial alone
};

/// The lambda of the system of solve_saddle() that minimises the criterion, over a logarithmic grid refined by golden
/// section; the largest where that is worse by at most a factor of 1 + 1 / n. One eigenvalue decomposition, O(9 n^3),
/// then O(n^2) for each of about 60 lambdas and each component (O(n) with generalised cross-validation). Throws as
/// solve_saddle().
SmoothingChoice choose_smoothing(const Eigen::Ref<const Eigen::MatrixXd>& A, const Eigen::Ref<const Eigen::MatrixXd>& G,
                                 const Eigen::Ref<const Eigen::MatrixXd>& s, const SmoothingOptions& options = {});

}  // namespace csrbf
