#include "csrbf/core/small_matrices.hpp"

#include "csrbf/core/dense_decompositions.hpp"

#include <Eigen/Cholesky>

template class Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>;
template class Eigen::JacobiSVD<Eigen::MatrixXd>;
template Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>& Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>::compute(
    const Eigen::EigenBase<Eigen::MatrixXd>&, int);

namespace csrbf {
namespace {

template <class Matrix>
SymmetricEigen by_iteration(const Matrix& A) {
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(A);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

template <class Matrix>
SymmetricEigen in_closed_form(const Matrix& A) {
  Eigen::SelfAdjointEigenSolver<Matrix> eigen;
  eigen.computeDirect(A);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

}  // namespace

SymmetricEigen symmetric_eigen(const Eigen::Ref<const SmallMatrix>& A) {
  if (A.rows() == 2) return by_iteration<Eigen::Matrix2d>(A);
  if (A.rows() == 3) return by_iteration<Eigen::Matrix3d>(A);
  return by_iteration<Eigen::MatrixXd>(A);
}

SymmetricEigen symmetric_eigen_direct(const Eigen::Ref<const SmallMatrix>& A) {
  if (A.rows() == 2) return in_closed_form<Eigen::Matrix2d>(A);
  if (A.rows() == 3) return in_closed_form<Eigen::Matrix3d>(A);
  return by_iteration<Eigen::MatrixXd>(A);
}

bool positive_definite(const Eigen::Ref<const SmallMatrix>& A) {
  return Eigen::LLT<SmallMatrix>(A).info() == Eigen::Success;
}

Eigen::Matrix<double, 6, 1> solve_symmetric(const Eigen::Matrix<double, 6, 6>& A,
                                            const Eigen::Matrix<double, 6, 1>& b) {
  return A.ldlt().solve(b);
}

double smallest_singular_value(const Eigen::Ref<const SmallMatrix>& A) {
  return Eigen::JacobiSVD<Eigen::MatrixXd>(Eigen::MatrixXd(A)).singularValues().tail<1>()[0];
}

}  // namespace csrbf
