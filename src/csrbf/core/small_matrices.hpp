#pragma once

#include "csrbf/core/types.hpp"

namespace csrbf {

/// Decompositions of matrices with at most six rows and columns, compiled once: Eigen's own headers for them take
/// seconds in every source file, and again for every size.
using SmallMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6>;
using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6, 1>;

/// A = vectors diag(values) vectors^T.
struct SymmetricEigen {
  SmallVector values;   ///< ascending
  SmallMatrix vectors;  ///< orthonormal columns
};

/// Eigenvalues and eigenvectors of a symmetric matrix, by QL iterations; its lower triangle is read.
SymmetricEigen symmetric_eigen(const Eigen::Ref<const SmallMatrix>& A);

/// The same in closed form for up to three rows: several times as fast, with absolute errors of about 1e-8 of the
/// largest eigenvalue. Larger matrices take symmetric_eigen().
SymmetricEigen symmetric_eigen_direct(const Eigen::Ref<const SmallMatrix>& A);

/// Whether the Cholesky factor of a symmetric matrix exists; its lower triangle is read.
bool positive_definite(const Eigen::Ref<const SmallMatrix>& A);

/// x with A x = b for a symmetric matrix without negative eigenvalues, such as that of a quadratic in two variables.
Eigen::Matrix<double, 6, 1> solve_symmetric(const Eigen::Matrix<double, 6, 6>& A, const Eigen::Matrix<double, 6, 1>& b);

/// 0 for singular matrices.
double smallest_singular_value(const Eigen::Ref<const SmallMatrix>& A);

}  // namespace csrbf
