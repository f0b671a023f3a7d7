#pragma once

#include "csrbf/core/types.hpp"

#include <Eigen/Core>

#include <optional>

namespace csrbf {

/// The criterion that a regularisation chosen from the data minimises.
enum class LambdaCriterion { generalized_cross_validation, leave_one_out };

struct RidgeOptions {
  std::optional<double> lambda0 = {};  ///< regularisation, independent of the number of data; unset: chosen from them
  LambdaCriterion criterion = LambdaCriterion::generalized_cross_validation;
  double smallest = 1e-14;       ///< lower end of the range that lambda0 is chosen from: interpolation up to rounding
  double largest = 1e2;          ///< upper end: all coefficients are nearly 0
  Eigen::VectorXd weights = {};  ///< one per datum; empty: all 1
};

/// A regularised fit to N data s with C components each, by M coefficients per component.
struct RidgeFit {
  Eigen::MatrixXd coefficients;      ///< M x C
  Eigen::MatrixXd fitted;            ///< N x C: f_k at the data
  Eigen::VectorXd hat_diagonal;      ///< N: S_kk = df_k/ds_k, in [0, 1]
  Eigen::MatrixXd leave_one_out;     ///< N x C: s_k - f_k of the fit with the same lambda to all other data
  double lambda0 = 0;                ///< given or chosen
  double lambda = 0;                 ///< lambda0 in units of the problem
  double gcv = 0;                    ///< mean_k w_k (s_k - f_k)^2 / (1 - tr S / N)^2 over all components
  double cross_validation_rmse = 0;  ///< weighted root mean square of `leave_one_out`
};

/// Ridge regression: minimises sum_k w_k |(B c - s)_k|^2 + lambda |c|^2 with lambda = lambda0 sum_k w_k / M, for an N x
/// M matrix B of any shape and N x C data. One singular value decomposition of W^(1/2) B serves every lambda, and the
/// condition of B is not squared. Data of weight 0 do not influence the fit; only their fitted values and errors are
/// reported. O(N M min(N, M)), plus O(N M) for each of about 60 lambdas tried.
///
/// The leave-one-out error is (s_k - f_k) / (1 - S_kk) (Allen 1974), the generalised cross-validation score that of
/// Craven and Wahba (1979). All components share one lambda, whose meaning does not depend on their number.
///
/// Throws InvalidInput for sizes that do not match, an empty B, entries that are not finite, weights that are negative
/// or all 0, a negative lambda0, and an empty range; SolverFailure if lambda0 = 0 and the columns of B are linearly
/// dependent.
RidgeFit ridge(const Eigen::Ref<const Eigen::MatrixXd>& B, const Eigen::Ref<const Eigen::MatrixXd>& s,
               const RidgeOptions& options = {});

/// Smoothed interpolation by a positive definite kernel: solves (A + lambda W^-1) c = s with the symmetric N x N kernel
/// matrix A, of which only the lower triangle is read, and lambda = lambda0 trace(A) / N. The fitted values are A c. It
/// minimises sum_k w_k |(A c - s)_k|^2 + lambda c^T A c; lambda0 = 0 interpolates. One eigenvalue decomposition,
/// O(N^3), serves every lambda. The leave-one-out error is c_k / ((A + lambda W^-1)^-1)_kk (Rippa 1999).
///
/// Throws InvalidInput as ridge() and for weights that are not positive; SolverFailure if A + lambda W^-1 is not
/// positive definite to working precision.
RidgeFit kernel_ridge(const Eigen::Ref<const Eigen::MatrixXd>& A, const Eigen::Ref<const Eigen::MatrixXd>& s,
                      const RidgeOptions& options = {});

}  // namespace csrbf
