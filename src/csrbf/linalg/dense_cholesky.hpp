#pragma once

#include "csrbf/core/types.hpp"

namespace csrbf {

/// Cholesky factors of dense matrices and what is done with them, block by block, most of it by panel_product():
/// from some hundred rows on twice as fast as by Eigen compiled for any processor. All may be interrupted.

/// C -= A B. O(rows inner columns).
void subtract_product(const Eigen::Ref<const Eigen::MatrixXd>& A, const Eigen::Ref<const Eigen::MatrixXd>& B,
                      Eigen::Ref<Eigen::MatrixXd> C);

/// Replaces the lower triangle of A by its Cholesky factor; false where A is not positive definite. The upper triangle
/// is neither read nor kept. O(n^3 / 3).
[[nodiscard]] bool cholesky_in_place(Eigen::Ref<Eigen::MatrixXd> A);

/// B := L^-1 B for the lower triangle L. O(n^2 columns).
void solve_lower_in_place(const Eigen::Ref<const Eigen::MatrixXd>& L, Eigen::Ref<Eigen::MatrixXd> B);

/// Replaces the lower triangle L by its inverse. O(n^3 / 3).
void invert_lower_in_place(Eigen::Ref<Eigen::MatrixXd> L);

}  // namespace csrbf
