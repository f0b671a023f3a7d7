#include "csrbf/core/small_matrices.hpp"

#include <gtest/gtest.h>

namespace csrbf::small_matrices_test {
namespace {

// Orthonormal, and different for every size: the product of reflections.
SmallMatrix rotation(Index n) {
  SmallMatrix Q = SmallMatrix::Identity(n, n);
  for (Index k = 0; k < n; ++k) {
    SmallVector v(n);
    for (Index i = 0; i < n; ++i) v[i] = std::sin(static_cast<double>(1 + i + 3 * k + n));
    v.normalize();
    Q = (Q - 2 * v * (v.transpose() * Q)).eval();
  }
  return Q;
}

SmallMatrix with_eigenvalues(const SmallVector& values) {
  const SmallMatrix Q = rotation(values.size());
  return Q * values.asDiagonal() * Q.transpose();
}

// 0.25, 1, 2.25, ... minus `shift`, ascending.
SmallVector squares(Index n, double shift = 0) {
  SmallVector values(n);
  for (Index i = 0; i < n; ++i) values[i] = 0.25 * static_cast<double>((i + 1) * (i + 1)) - shift;
  return values;
}

class SmallMatrices : public testing::TestWithParam<Index> {};

TEST_P(SmallMatrices, HaveTheirEigenvaluesAndVectors) {
  const SmallVector values = squares(GetParam(), 0.5);
  const SmallMatrix A = with_eigenvalues(values);
  for (const SymmetricEigen& eigen : {symmetric_eigen(A), symmetric_eigen_direct(A)}) {
    ASSERT_EQ(eigen.values.size(), GetParam());
    EXPECT_LT((eigen.values - values).norm(), 1e-12);
    EXPECT_LT((A * eigen.vectors - eigen.vectors * eigen.values.asDiagonal()).norm(), 1e-12);
    EXPECT_LT((eigen.vectors.transpose() * eigen.vectors - SmallMatrix::Identity(GetParam(), GetParam())).norm(),
              1e-12);
  }
}

TEST_P(SmallMatrices, AreReadInTheirLowerTriangle) {
  const SmallMatrix A = with_eigenvalues(squares(GetParam()));
  SmallMatrix lower = A.triangularView<Eigen::Lower>();
  EXPECT_LT((symmetric_eigen(lower).values - squares(GetParam())).norm(), 1e-12);
  EXPECT_TRUE(positive_definite(lower));
}

TEST_P(SmallMatrices, ArePositiveDefiniteWithPositiveEigenvalues) {
  EXPECT_TRUE(positive_definite(with_eigenvalues(squares(GetParam()))));
  EXPECT_FALSE(positive_definite(with_eigenvalues(squares(GetParam(), 0.26))));  // the smallest is -0.01
  EXPECT_FALSE(positive_definite(SmallMatrix::Zero(GetParam(), GetParam())));
}

TEST_P(SmallMatrices, HaveASmallestSingularValue) {
  const Index n = GetParam();
  const SmallVector values = squares(n, 10).cwiseAbs();
  EXPECT_NEAR(smallest_singular_value(rotation(n) * values.asDiagonal()), values.minCoeff(), 1e-12);
  EXPECT_EQ(smallest_singular_value(SmallMatrix::Zero(n, n)), 0);
}

INSTANTIATE_TEST_SUITE_P(OfEverySize, SmallMatrices, testing::Range<Index>(1, 7));

TEST(SmallMatrices, MayBePartsOfOthers) {
  Eigen::Matrix3d A = Eigen::Vector3d(3, 2, 1).asDiagonal();
  EXPECT_EQ(symmetric_eigen(A.topLeftCorner<2, 2>()).values, Eigen::Vector2d(2, 3));
  EXPECT_EQ(smallest_singular_value(2 * A), 2);
}

}  // namespace
}  // namespace csrbf::small_matrices_test
