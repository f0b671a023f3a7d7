#pragma once

#include "csrbf/core/types.hpp"

#include <Eigen/SparseCore>

#include <functional>
#include <memory>

namespace csrbf {

/// A Cholesky factorisation of sparse symmetric positive definite matrices by another solver than the library's own.
class SparseFactor {
 public:
  SparseFactor() = default;
  SparseFactor(const SparseFactor&) = delete;
  SparseFactor& operator=(const SparseFactor&) = delete;
  virtual ~SparseFactor() = default;

  /// Factorises N, of which the lower triangle is read; `known`: its pattern is that of the call before. Returns
  /// whether N is positive definite to working precision.
  virtual bool factorize(const Eigen::SparseMatrix<double>& N, bool known) = 0;

  /// Solves for every column of b.
  [[nodiscard]] virtual Eigen::MatrixXd solve(const Eigen::Ref<const Eigen::MatrixXd>& b) const = 0;
};

/// Makes the factor of a matrix like N; null: it is left to the library.
using SparseFactorMaker = std::function<std::unique_ptr<SparseFactor>(const Eigen::SparseMatrix<double>& N)>;

/// From now on SparseCholesky asks `maker` before it makes a factor itself, unless it is inside a parallel loop; empty:
/// nobody (default). Which systems are solved directly does not change.
void set_sparse_factor(SparseFactorMaker maker);

}  // namespace csrbf
