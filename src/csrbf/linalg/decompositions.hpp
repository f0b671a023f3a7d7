#pragma once

#include "csrbf/core/dense_decompositions.hpp"
#include "csrbf/core/types.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>

// Eigen's decompositions of matrices of any size are compiled once, in decompositions.cpp: files that use them would
// otherwise take seconds for each.
extern template class Eigen::LLT<Eigen::MatrixXd>;
extern template class Eigen::LDLT<Eigen::MatrixXd>;
extern template class Eigen::PartialPivLU<Eigen::MatrixXd>;
extern template class Eigen::HouseholderQR<Eigen::MatrixXd>;
extern template class Eigen::ColPivHouseholderQR<Eigen::MatrixXd>;
extern template Eigen::LLT<Eigen::MatrixXd>& Eigen::LLT<Eigen::MatrixXd>::compute(
    const Eigen::EigenBase<Eigen::MatrixXd>&);
extern template Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>& Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>::compute(
    const Eigen::EigenBase<Eigen::Ref<Eigen::MatrixXd>>&);
extern template Eigen::LDLT<Eigen::MatrixXd>& Eigen::LDLT<Eigen::MatrixXd>::compute(
    const Eigen::EigenBase<Eigen::MatrixXd>&);

namespace csrbf {

/// The first columns of Q.
Eigen::MatrixXd thin_q(const Eigen::HouseholderQR<Eigen::MatrixXd>& qr, Index columns);

/// A = Q^T A.
void apply_q_transposed(const Eigen::HouseholderQR<Eigen::MatrixXd>& qr, Eigen::MatrixXd& A);

/// A = A Q.
void apply_q_on_the_right(const Eigen::HouseholderQR<Eigen::MatrixXd>& qr, Eigen::MatrixXd& A);

/// X = L^-1 X and X = L^-T X.
void solve_lower(const Eigen::LLT<Eigen::MatrixXd>& llt, Eigen::MatrixXd& X);
void solve_lower(const Eigen::LLT<Eigen::MatrixXd>& llt, Eigen::VectorXd& x);
void solve_lower(const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>& llt, Eigen::MatrixXd& X);
void solve_upper(const Eigen::LLT<Eigen::MatrixXd>& llt, Eigen::MatrixXd& X);

/// A^-1 B and A^-1 b.
Eigen::MatrixXd solve(const Eigen::LDLT<Eigen::MatrixXd>& ldlt, const Eigen::MatrixXd& B);
Eigen::VectorXd solve(const Eigen::LDLT<Eigen::MatrixXd>& ldlt, const Eigen::VectorXd& b);
Eigen::MatrixXd solve_by_lu(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);
Eigen::VectorXd solve_by_lu(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

/// A^-1, and whether there is one. Compiled once: of matrices of fixed sizes they would take the compiler seconds each.
Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& A);
bool is_regular(const Eigen::MatrixXd& A);

/// The least squares solution.
Eigen::VectorXd solve(const Eigen::HouseholderQR<Eigen::MatrixXd>& qr, const Eigen::VectorXd& b);
Eigen::VectorXd solve(const Eigen::ColPivHouseholderQR<Eigen::MatrixXd>& qr, const Eigen::VectorXd& b);

}  // namespace csrbf
