#pragma once

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

// Eigen's iterations for matrices of any size are compiled once, in small_matrices.cpp, which uses them too.
extern template class Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>;
extern template class Eigen::JacobiSVD<Eigen::MatrixXd>;
extern template Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>& Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>::compute(
    const Eigen::EigenBase<Eigen::MatrixXd>&, int);
