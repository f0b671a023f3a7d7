#pragma once

#include "csrbf/core/types.hpp"

#include <Eigen/SparseCore>

#include <functional>
#include <memory>

namespace csrbf {

/// A Cholesky factorisation of sparse symmetric positive definite matrices by a solver other than the library's own.
class SparseFactor {
 public:
  SparseFactor() = default;
  SparseFactor(const SparseFactor&) = delete;
  SparseFactor& operator=(const SparseFactor&) = delete;
  virtual ~SparseFactor() = default;

  /// Factorises N, of which the lower triangle is read; `known`: its pattern is that of the previous call. Returns
  /// whether N is positive definite to working precision.
  virtual bool factorize(const Eigen::SparseMatrix<double>& N, bool known) = 0;

  /// Solves for every column of b.
  [[nodiscard]] virtual Eigen::MatrixXd solve(const Eigen::Ref<const Eigen::MatrixXd>& b) const = 0;
};

/// Makes a factor for matrices with the pattern of N, or returns null to leave them to the library.
using SparseFactorMaker = std::function<std::unique_ptr<SparseFactor>(const Eigen::SparseMatrix<double>& N)>;

/// From now on SparseCholesky uses the factors of `maker`, where it makes any, except inside a parallel loop; empty
/// (default): its own. Which systems are solved directly does not change.
void set_sparse_factor(SparseFactorMaker maker);

}  // namespace csrbf
