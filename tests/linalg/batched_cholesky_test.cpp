#include "csrbf/linalg/batched_cholesky.hpp"

#include "csrbf/core/simd.hpp"

#include <gtest/gtest.h>
#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>

#include <array>
#include <limits>
#include <random>
#include <vector>

namespace csrbf::batched_cholesky_test {
namespace {

constexpr double rounding = 1e-12;  // condition numbers below stay under a few hundred

using Batch = std::array<Eigen::MatrixXd, batch_lanes>;

Eigen::MatrixXd random_matrix(Index rows, Index cols, std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  return Eigen::MatrixXd::NullaryExpr(rows, cols, [&] { return uniform(random); });
}

// Different in every lane, and far from singular.
Batch random_systems(Index n, unsigned seed) {
  std::mt19937_64 random(seed);
  Batch systems;
  for (Eigen::MatrixXd& A : systems) {
    const Eigen::MatrixXd B = random_matrix(n, n, random);
    A = B * B.transpose() + Eigen::MatrixXd::Identity(n, n);
  }
  return systems;
}

std::vector<double> interleave_triangles(const Batch& systems) {
  const Index n = systems[0].rows();
  std::vector<double> A(batch_matrix_size(n));
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j <= i; ++j)
      for (int s = 0; s < batch_lanes; ++s) A[batch_entry(i, j) + s] = systems[s](i, j);
  return A;
}

// Column after column, as right-hand sides; also the rows of F when the matrix holds them as columns.
std::vector<double> interleave_columns(const Batch& columns) {
  std::vector<double> b;
  for (Index r = 0; r < columns[0].cols(); ++r)
    for (Index i = 0; i < columns[0].rows(); ++i)
      for (const Eigen::MatrixXd& lane : columns) b.push_back(lane(i, r));
  return b;
}

Eigen::MatrixXd columns_of_lane(const std::vector<double>& b, Index n, int lane) {
  Eigen::MatrixXd x(n, static_cast<Index>(b.size()) / (batch_lanes * n));
  for (Index i = 0; i < x.size(); ++i) x.reshaped()[i] = b[batch_lanes * i + lane];
  return x;
}

TEST(BatchedCholesky, FactorisesASmallMatrixExactly) {
  Eigen::Matrix3d A;
  A << 4, 2, 8, 2, 10, 1, 8, 1, 33;  // L = [2; 1 3; 4 -1 4]
  Batch systems;
  systems.fill(A);
  std::vector<double> L = interleave_triangles(systems);
  EXPECT_EQ(batch_cholesky(L.data(), 3), 0U);
  const double expected[] = {.5, 1, 1.0 / 3, 4, -1, .25};
  for (std::size_t entry = 0; entry < 6; ++entry)
    for (std::size_t s = 0; s < batch_lanes; ++s) EXPECT_DOUBLE_EQ(L[batch_lanes * entry + s], expected[entry]);
}

TEST(BatchedCholesky, SolvesEveryLaneLikeADenseSolver) {
  for (Index n = 1; n <= 23; ++n) {
    for (const Index count : {1, 2, 3, 4, 7}) {
      const Batch systems = random_systems(n, static_cast<unsigned>(n));
      std::mt19937_64 random(99);
      Batch right;
      for (Eigen::MatrixXd& b : right) b = random_matrix(n, count, random);
      std::vector<double> A = interleave_triangles(systems);
      std::vector<double> x = interleave_columns(right);
      ASSERT_EQ(batch_cholesky(A.data(), n), 0U);
      batch_solve(A.data(), n, x.data(), count);
      for (int s = 0; s < batch_lanes; ++s) {
        const auto lane = static_cast<std::size_t>(s);
        const Eigen::MatrixXd expected = systems[lane].fullPivLu().solve(right[lane]);
        EXPECT_LT((columns_of_lane(x, n, s) - expected).norm(), rounding * expected.norm()) << n << " " << count;
      }
    }
  }
}

TEST(BatchedCholesky, HasTheFactorOfADenseSolverAlsoForLargeSystems) {
  for (const Index n : {32, 50, 64, 85}) {
    const Batch systems = random_systems(n, static_cast<unsigned>(n));
    std::vector<double> A = interleave_triangles(systems);
    ASSERT_EQ(batch_cholesky(A.data(), n), 0U);
    for (std::size_t s = 0; s < batch_lanes; ++s) {
      const Eigen::MatrixXd L = systems[s].llt().matrixL();
      for (Index i = 0; i < n; ++i) {
        for (Index j = 0; j <= i; ++j) {
          const double entry = A[static_cast<std::size_t>(batch_entry(i, j)) + s];
          EXPECT_NEAR(i == j ? 1 / entry : entry, L(i, j), rounding * L(i, i));
        }
      }
    }
  }
}

TEST(BatchedCholesky, GathersTheSameGramMatrixAsADenseProduct) {
  for (const Index n : {1, 2, 3, 4, 5, 16, 21, 32, 64}) {
    for (const Index rows : {0, 1, 5, 40, 150}) {
      std::mt19937_64 random(7);
      Batch transposed;
      for (Eigen::MatrixXd& F : transposed) F = random_matrix(n, rows, random);
      const std::vector<double> F = interleave_columns(transposed);
      std::vector<double> A(batch_matrix_size(n), 2.5);
      batch_gram(F.data(), rows, n, A.data());
      for (std::size_t s = 0; s < batch_lanes; ++s) {
        const Eigen::MatrixXd gram = transposed[s] * transposed[s].transpose();
        for (Index i = 0; i < n; ++i)
          for (Index j = 0; j <= i; ++j)
            ASSERT_NEAR(A[static_cast<std::size_t>(batch_entry(i, j)) + s], 2.5 + gram(i, j), rounding);
      }
    }
  }
}

TEST(BatchedCholesky, SolvesLeastSquaresWithTheDataAsLastColumn) {
  constexpr Index unknowns = 11;
  constexpr Index rows = 40;
  std::mt19937_64 random(3);
  Batch transposed;
  for (Eigen::MatrixXd& F : transposed) F = random_matrix(unknowns + 1, rows, random);
  const std::vector<double> F = interleave_columns(transposed);
  std::vector<double> A(batch_matrix_size(unknowns + 1), 0.0);
  batch_gram(F.data(), rows, unknowns + 1, A.data());
  ASSERT_EQ(batch_cholesky(A.data(), unknowns), 0U);
  double* right = A.data() + batch_entry(unknowns, 0);
  batch_solve(A.data(), unknowns, right);
  for (int s = 0; s < batch_lanes; ++s) {
    const Eigen::MatrixXd& lane = transposed[s];
    const Eigen::MatrixXd B = lane.topRows(unknowns).transpose();
    const Eigen::VectorXd expected = B.colPivHouseholderQr().solve(lane.row(unknowns).transpose());
    for (Index i = 0; i < unknowns; ++i) EXPECT_NEAR(right[batch_lanes * i + s], expected[i], rounding);
  }
}

TEST(BatchedCholesky, ReportsAFailedPivotAndLeavesItsUnknownOut) {
  constexpr Index n = 7;
  for (Index bad = 0; bad < n; ++bad) {
    Batch systems = random_systems(n, 8);
    const std::vector<double> untouched = interleave_triangles(systems);
    systems[2](bad, bad) = -1;
    systems[5](bad, bad) = 0;
    Batch right;
    right.fill(Eigen::VectorXd::LinSpaced(n, 1, 2));
    std::vector<double> A = interleave_triangles(systems);
    std::vector<double> x = interleave_columns(right);
    EXPECT_EQ(batch_cholesky(A.data(), n), 1U << 2 | 1U << 5);
    batch_solve(A.data(), n, x.data());

    std::vector<Index> others;
    for (Index i = 0; i < n; ++i)
      if (i != bad) others.push_back(i);
    for (const int s : {2, 5}) {
      const Eigen::VectorXd solution = columns_of_lane(x, n, s);
      const Eigen::MatrixXd reduced = systems[s](others, others);
      const Eigen::VectorXd expected = reduced.fullPivLu().solve(right[0](others, 0));
      EXPECT_EQ(solution[bad], 0);
      EXPECT_LT((solution(others) - expected).norm(), rounding);
    }
    std::vector<double> L = untouched;
    EXPECT_EQ(batch_cholesky(L.data(), n), 0U);
    for (std::size_t i = 0; i < A.size(); ++i)
      EXPECT_TRUE(i % batch_lanes == 2 || i % batch_lanes == 5 || A[i] == L[i]);
  }
}

TEST(BatchedCholesky, FindsLinearDependenceThroughTheTolerance) {
  constexpr Index n = 6;
  constexpr double tolerance = 1e-12;
  std::mt19937_64 random(4);
  Batch systems = random_systems(n, 9);
  Eigen::MatrixXd B = random_matrix(20, n, random);
  B.col(4) = B.col(1) - 2 * B.col(2);
  systems[3] = B.transpose() * B;
  const Eigen::VectorXd data = random_matrix(20, 1, random);
  Batch right;
  right.fill(B.transpose() * data);
  std::vector<double> A = interleave_triangles(systems);
  std::vector<double> x = interleave_columns(right);
  EXPECT_EQ(batch_cholesky(A.data(), n, tolerance), 1U << 3);
  batch_solve(A.data(), n, x.data());
  const Eigen::VectorXd solution = columns_of_lane(x, n, 3);
  EXPECT_EQ(solution[4], 0);
  const Eigen::VectorXd residual = data - B * solution;
  EXPECT_LT((B.transpose() * residual).norm(), 1e-10);  // still a least squares solution
}

TEST(BatchedCholesky, KeepsNaNInItsLane) {
  constexpr Index n = 5;
  Batch systems = random_systems(n, 12);
  std::vector<double> expected = interleave_triangles(systems);
  systems[0](3, 1) = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> A = interleave_triangles(systems);
  EXPECT_EQ(batch_cholesky(A.data(), n), 1U);
  EXPECT_EQ(batch_cholesky(expected.data(), n), 0U);
  for (std::size_t i = 0; i < A.size(); ++i) EXPECT_TRUE(i % batch_lanes == 0 || A[i] == expected[i]);
}

TEST(BatchedCholesky, DoesNotDependOnTheScaleOfTheSystems) {
  constexpr Index n = 8;
  Batch systems = random_systems(n, 13);
  std::vector<double> unit = interleave_triangles(systems);
  batch_cholesky(unit.data(), n);
  for (const int exponent : {-600, 600}) {  // even: the square root is exact too
    Batch scaled = systems;
    for (Eigen::MatrixXd& A : scaled) A *= std::ldexp(1.0, exponent);
    std::vector<double> A = interleave_triangles(scaled);
    EXPECT_EQ(batch_cholesky(A.data(), n, 1e-14), 0U);
    for (Index i = 0; i < n; ++i)
      for (Index j = 0; j <= i; ++j)
        EXPECT_EQ(std::ldexp(A[batch_entry(i, j)], (i == j ? 1 : -1) * exponent / 2), unit[batch_entry(i, j)]);
  }
}

}  // namespace
}  // namespace csrbf::batched_cholesky_test
