#include "csrbf/linalg/decompositions.hpp"

template class Eigen::LLT<Eigen::MatrixXd>;
template class Eigen::LDLT<Eigen::MatrixXd>;
template class Eigen::PartialPivLU<Eigen::MatrixXd>;
template class Eigen::HouseholderQR<Eigen::MatrixXd>;
template class Eigen::ColPivHouseholderQR<Eigen::MatrixXd>;
template Eigen::LLT<Eigen::MatrixXd>& Eigen::LLT<Eigen::MatrixXd>::compute(const Eigen::EigenBase<Eigen::MatrixXd>&);
template Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>& Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>::compute(
    const Eigen::EigenBase<Eigen::Ref<Eigen::MatrixXd>>&);
template Eigen::LDLT<Eigen::MatrixXd>& Eigen::LDLT<Eigen::MatrixXd>::compute(const Eigen::EigenBase<Eigen::MatrixXd>&);

namespace csrbf {

Eigen::MatrixXd thin_q(const Eigen::HouseholderQR<Eigen::MatrixXd>& qr, Index columns) {
  return qr.householderQ() * Eigen::MatrixXd::Identity(qr.rows(), columns);
}

void apply_q_transposed(const Eigen::HouseholderQR<Eigen::MatrixXd>& qr, Eigen::MatrixXd& A) {
  A.applyOnTheLeft(qr.householderQ().transpose());
}

void apply_q_on_the_right(const Eigen::HouseholderQR<Eigen::MatrixXd>& qr, Eigen::MatrixXd& A) {
  A.applyOnTheRight(qr.householderQ());
}

void solve_lower(const Eigen::LLT<Eigen::MatrixXd>& llt, Eigen::MatrixXd& X) {
  llt.matrixL().solveInPlace(X);
}

void solve_lower(const Eigen::LLT<Eigen::MatrixXd>& llt, Eigen::VectorXd& x) {
  llt.matrixL().solveInPlace(x);
}

void solve_lower(const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>& llt, Eigen::MatrixXd& X) {
  llt.matrixL().solveInPlace(X);
}

void solve_upper(const Eigen::LLT<Eigen::MatrixXd>& llt, Eigen::MatrixXd& X) {
  llt.matrixU().solveInPlace(X);
}

Eigen::MatrixXd solve(const Eigen::LDLT<Eigen::MatrixXd>& ldlt, const Eigen::MatrixXd& B) {
  return ldlt.solve(B);
}

Eigen::VectorXd solve(const Eigen::LDLT<Eigen::MatrixXd>& ldlt, const Eigen::VectorXd& b) {
  return ldlt.solve(b);
}

Eigen::MatrixXd solve_by_lu(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
  return A.partialPivLu().solve(B);
}

Eigen::VectorXd solve_by_lu(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  return A.partialPivLu().solve(b);
}

Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& A) {
  return solve_by_lu(A, Eigen::MatrixXd(Eigen::MatrixXd::Identity(A.rows(), A.cols())));
}

bool is_regular(const Eigen::MatrixXd& A) {
  return A.partialPivLu().determinant() != 0;
}

Eigen::VectorXd solve(const Eigen::HouseholderQR<Eigen::MatrixXd>& qr, const Eigen::VectorXd& b) {
  return qr.solve(b);
}

Eigen::VectorXd solve(const Eigen::ColPivHouseholderQR<Eigen::MatrixXd>& qr, const Eigen::VectorXd& b) {
  return qr.solve(b);
}

}  // namespace csrbf
