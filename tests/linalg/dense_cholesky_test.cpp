#include "csrbf/linalg/dense_cholesky.hpp"

#include <gtest/gtest.h>

namespace csrbf::dense_cholesky_test {
namespace {

using Matrix = Eigen::MatrixXd;

Matrix definite(Index n) {
  const Matrix X = Matrix::Random(n, n);
  return X * X.transpose() + static_cast<double>(n) * Matrix::Identity(n, n);
}

// Around the sizes of blocks.
constexpr Index sizes[] = {0, 1, 7, 48, 49, 95, 96, 97, 200, 391};

TEST(DenseCholesky, GivesTheFactorOfTheLowerTriangle) {
  for (const Index n : sizes) {
    const Matrix A = definite(n);
    Matrix L = A;
    L.triangularView<Eigen::StrictlyUpper>().setConstant(7);
    ASSERT_TRUE(cholesky_in_place(L)) << n;
    const Matrix lower = L.triangularView<Eigen::Lower>();
    EXPECT_LE((lower * lower.transpose() - A).norm(), 1e-13 * (1 + A.norm())) << n;
  }
}

TEST(DenseCholesky, KnowsIndefiniteMatrices) {
  for (const Index n : {1, 60, 200, 391}) {
    Matrix A = definite(n);
    A(n - 1, n - 1) = -1;
    EXPECT_FALSE(cholesky_in_place(A)) << n;
  }
}

TEST(DenseCholesky, SolvesAndInverts) {
  for (const Index n : sizes) {
    Matrix L = definite(n);
    ASSERT_TRUE(cholesky_in_place(L));
    const Matrix lower = L.triangularView<Eigen::Lower>(), B = Matrix::Random(n, 101);
    Matrix X = B;
    solve_lower_in_place(L, X);
    EXPECT_LE((lower * X - B).norm(), 1e-13 * (1 + B.norm())) << n;
    invert_lower_in_place(L);
    const Matrix inverse = L.triangularView<Eigen::Lower>();
    EXPECT_LE((inverse * lower - Matrix::Identity(n, n)).norm(), 1e-12 * static_cast<double>(n + 1)) << n;
  }
}

TEST(DenseCholesky, SubtractsProductsOfParts) {
  const Matrix A = Matrix::Random(211, 403), B = Matrix::Random(403, 133), C = Matrix::Random(211, 133);
  Matrix rest = C;
  subtract_product(A, B, rest);
  EXPECT_LE((C - A * B - rest).norm(), 1e-12 * C.norm());
  Matrix part = C;
  subtract_product(A.block(5, 7, 50, 30), B.block(2, 3, 30, 20), part.block(1, 1, 50, 20));
  Matrix expected = C;
  expected.block(1, 1, 50, 20) -= A.block(5, 7, 50, 30) * B.block(2, 3, 30, 20);
  EXPECT_LE((expected - part).norm(), 1e-13 * C.norm());
}

}  // namespace
}  // namespace csrbf::dense_cholesky_test
