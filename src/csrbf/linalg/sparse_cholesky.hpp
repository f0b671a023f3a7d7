#pragma once

#include "csrbf/core/progress.hpp"
#include "csrbf/core/types.hpp"

#include <Eigen/SparseCore>

#include <memory>

namespace csrbf {

enum class SparseMethod { automatic, direct, iterative };

struct SparseCholeskyOptions {
  SparseMethod method = SparseMethod::automatic;  ///< automatic: direct unless it needs more than `direct_flops`
  double direct_flops = 2e10;                     ///< of a factorisation, about 20 seconds; chosen by hand
  double tolerance = 1e-12;                       ///< iterative: |residual| <= tolerance |right-hand side|
  Index max_iterations = 5000;                    ///< iterative, per right-hand side
  Progress progress = {};                         ///< stage "solve"
};

/// Solves N x = b for a sparse symmetric positive definite N: by a Cholesky factorisation after an approximate minimum
/// degree ordering, or by conjugate gradients preconditioned with an incomplete factorisation where the factor would be
/// too expensive (decided by its exact operation count, before any of it is computed).
class SparseCholesky {
 public:
  explicit SparseCholesky(SparseCholeskyOptions options = {});
  SparseCholesky(SparseCholesky&&) noexcept;
  SparseCholesky& operator=(SparseCholesky&&) noexcept;
  ~SparseCholesky();

  /// Prepares for N, of which the lower triangle is read. For a matrix with the same sparsity as the previous one the
  /// ordering is reused.
  /// Returns whether N is positive definite to working precision (for the iterative method: whether a preconditioner
  /// was found; indefiniteness shows up in solve).
  bool factorize(const Eigen::SparseMatrix<double>& N);

  /// Solves for every column of b. Throws SolverFailure when the iteration does not reach even the square root of the
  /// tolerance.
  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::Ref<const Eigen::MatrixXd>& b) const;

  [[nodiscard]] bool direct() const;       ///< the method in use
  [[nodiscard]] Index iterations() const;  ///< of all solves so far; 0 for the direct method

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace csrbf
