#pragma once

#include "csrbf/linalg/sparse_cholesky.hpp"

#include <optional>

namespace csrbf {

/// offset + slope . c of coefficients c.
struct AffineFunction {
  double offset = 1;
  Eigen::VectorXd slope = {};  ///< one per coefficient, or none: constant
};

struct SparseLeastSquaresOptions {
  std::optional<double> lambda0 = {};        ///< regularisation independent of the number of data; default: chosen
  Eigen::VectorXd weights = {};              ///< one per datum, not negative; default: all 1
  Eigen::SparseMatrix<double> penalty = {};  ///< P, M x M symmetric positive definite; default: the identity
  double smallest = 1e-12;                   ///< lower end of the range lambda0 is chosen from
  double largest = 1e2;                      ///< upper end
  /// The unit of the residuals when lambda0 is chosen: the score is divided by the square of this function of the
  /// coefficients. For data that a shrunken model satisfies better, as a flat f does f = 0.
  AffineFunction score_unit = {};
  SparseCholeskyOptions solver = {};
};

struct SparseLeastSquaresFit {
  Eigen::MatrixXd coefficients;  ///< M x C; 0 for the columns that were dropped
  Eigen::MatrixXd fitted;        ///< N x C: B c
  double lambda0 = 0;            ///< used or chosen
  double lambda = 0;             ///< lambda0 in units of the problem
  double gcv = 0;                ///< see below, over the square of the unit; 0 when lambda0 was given
  Index dropped = 0;             ///< number of columns without an entry in a row of positive weight
  bool direct = true;            ///< how the equations were solved
  Index iterations = 0;          ///< of the iterative method
};

/// Regularised least squares with a sparse N x M matrix B and N x C data s, one factorisation for all components:
/// minimises sum_k w_k |(B c - s)_k|^2 + lambda c^T P c, lambda = lambda0 sum_k w_k / trace(P). P = identity is the
/// ridge penalty; the kernel matrix of the centres penalises the native space norm of the fit instead.
///
/// The normal equations are solved, then refined once with the residual of the least squares problem, so that for
/// lambda0 >= 1e-12 or so the condition of B^T B affects only the last digits. Without `lambda0` it minimises
/// generalised cross-validation (Craven and Wahba 1979), mean_k w_k |(s - B c)_k|^2 / (1 - tr S / N)^2, over about 20
/// values; the trace is exact for up to 256 columns and estimated by 16 fixed random probes beyond (Hutchinson 1989).
///
/// Throws InvalidInput for sizes that do not match, empty B, entries that are not finite, negative or all zero weights,
/// negative lambda0 or an empty range; SolverFailure when the normal equations are not positive definite to working
/// precision (for lambda0 = 0: the columns of B are linearly dependent) or the iteration does not converge.
SparseLeastSquaresFit sparse_least_squares(const Eigen::SparseMatrix<double, Eigen::RowMajor>& B,
                                           const Eigen::Ref<const Eigen::MatrixXd>& s,
                                           const SparseLeastSquaresOptions& options = {});

}  // namespace csrbf
