#include "csrbf/linalg/dense_cholesky.hpp"

#include "csrbf/core/interruption.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/linalg/panel_product.hpp"

#include <Eigen/Cholesky>

#include <algorithm>

namespace csrbf {
namespace {

using Eigen::Lower;
using Matrix = Eigen::MatrixXd;

// Chosen by hand: panels of rows x inner fit the second-level cache; smaller products are left to Eigen.
constexpr Index rows_at_once = 96, inner_at_once = 192, columns_at_once = 96;
constexpr Index small = 48;

bool split_evenly(Index n, Index& half) {
  half = (n / 2 + panel_rows - 1) / panel_rows * panel_rows;
  return n > small;
}

}  // namespace

void subtract_product(const Eigen::Ref<const Matrix>& A, const Eigen::Ref<const Matrix>& B, Eigen::Ref<Matrix> C) {
  const Index blocks = (A.rows() + rows_at_once - 1) / rows_at_once;
  parallel_for(blocks, 1, [&](Index begin, Index end) {
    Matrix panel, sums;
    for (Index b = begin; b < end; ++b) {
      const Index row = b * rows_at_once, rows = std::min(rows_at_once, A.rows() - row);
      for (Index k = 0; k < A.cols(); k += inner_at_once) {
        const Index inner = std::min(inner_at_once, A.cols() - k);
        panel.setZero(padded_rows(rows), inner);
        panel.topRows(rows) = -A.block(row, k, rows, inner);
        for (Index c = 0; c < C.cols(); c += columns_at_once) {
          const Index columns = std::min(columns_at_once, C.cols() - c);
          sums.setZero(panel.rows(), columns);
          sums.topRows(rows) = C.block(row, c, rows, columns);
          panel_product(panel.data(), panel.rows(), inner, &B.coeffRef(k, c), B.outerStride(), columns, sums.data());
          C.block(row, c, rows, columns) = sums.topRows(rows);
        }
      }
    }
  });
}

// By halves: the second one less the product of the corner with its transpose, in strips below the diagonal.
bool cholesky_in_place(Eigen::Ref<Matrix> A) {
  const Index n = A.rows();
  Index half = 0;
  if (!split_evenly(n, half)) return Eigen::internal::llt_inplace<double, Lower>::unblocked(A) < 0;
  stop_if_interrupted();
  if (!cholesky_in_place(A.topLeftCorner(half, half))) return false;
  const Index rest = n - half;
  Matrix below = A.bottomLeftCorner(rest, half).transpose();
  solve_lower_in_place(A.topLeftCorner(half, half), below);
  A.bottomLeftCorner(rest, half) = below.transpose();
  for (Index c = 0; c < rest; c += columns_at_once) {
    const Index columns = std::min(columns_at_once, rest - c);
    subtract_product(A.bottomLeftCorner(rest - c, half), below.middleCols(c, columns),
                     A.block(half + c, half + c, rest - c, columns));
  }
  return cholesky_in_place(A.bottomRightCorner(rest, rest));
}

void solve_lower_in_place(const Eigen::Ref<const Matrix>& L, Eigen::Ref<Matrix> B) {
  const Index n = L.rows();
  Index half = 0;
  if (!split_evenly(n, half)) {
    L.triangularView<Lower>().solveInPlace(B);
    return;
  }
  stop_if_interrupted();
  solve_lower_in_place(L.topLeftCorner(half, half), B.topRows(half));
  subtract_product(L.bottomLeftCorner(n - half, half), B.topRows(half), B.bottomRows(n - half));
  solve_lower_in_place(L.bottomRightCorner(n - half, n - half), B.bottomRows(n - half));
}

// The corner of the inverse is -L22^-1 L21 L11^-1.
void invert_lower_in_place(Eigen::Ref<Matrix> L) {
  const Index n = L.rows();
  Index half = 0;
  if (!split_evenly(n, half)) {
    Matrix inverse = Matrix::Identity(n, n);
    L.triangularView<Lower>().solveInPlace(inverse);
    L.triangularView<Lower>() = inverse;
    return;
  }
  stop_if_interrupted();
  const Index rest = n - half;
  Matrix corner = L.bottomLeftCorner(rest, half);
  solve_lower_in_place(L.bottomRightCorner(rest, rest), corner);
  invert_lower_in_place(L.topLeftCorner(half, half));
  invert_lower_in_place(L.bottomRightCorner(rest, rest));
  L.bottomLeftCorner(rest, half).setZero();
  Matrix inverse = L.topLeftCorner(half, half).triangularView<Lower>();
  for (Index c = 0; c < half; c += columns_at_once) {
    const Index columns = std::min(columns_at_once, half - c);
    subtract_product(corner.rightCols(half - c), inverse.block(c, c, half - c, columns),
                     L.block(half, c, rest, columns));
  }
}

}  // namespace csrbf
