#include "csrbf/linalg/batched_saddle.hpp"

#include <gtest/gtest.h>
#include <Eigen/LU>

#include <random>
#include <vector>

namespace csrbf::batched_saddle_test {
namespace {

constexpr double rounding = 1e-11;  // condition numbers below stay under a few thousand

struct Systems {
  Index n, Q, count;
  std::vector<Eigen::MatrixXd> A, G, s;
  std::vector<double> matrix, polynomial, right, pi;
  BatchMask failed = 0;

  Systems(Index rows, Index columns, Index sides, unsigned seed) : n(rows), Q(columns), count(sides) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(-1, 1);
    const auto matrix_of = [&](Index r, Index c) {
      return Eigen::MatrixXd(Eigen::MatrixXd::NullaryExpr(r, c, [&] { return uniform(random); }));
    };
    for (int l = 0; l < batch_lanes; ++l) {
      const Eigen::MatrixXd B = matrix_of(n, n);
      A.emplace_back(B * B.transpose() + Eigen::MatrixXd::Identity(n, n));
      G.push_back(matrix_of(n, Q));
      s.push_back(matrix_of(n, count));
      // Indefinite, but positive definite on the null space of G^T.
      if (Q > 0) A.back() -= 20 * G.back().col(0) * G.back().col(0).transpose();
    }
  }

  void solve() {
    matrix.resize(batch_matrix_size(n));
    polynomial.resize(batch_lanes * n * Q);
    right.resize(batch_lanes * n * count);
    pi.resize(batch_lanes * Q * count);
    std::vector<double> work(batch_saddle_work(n));
    for (int l = 0; l < batch_lanes; ++l) {
      const auto lane = static_cast<std::size_t>(l);
      for (Index i = 0; i < n; ++i) {
        for (Index j = 0; j <= i; ++j) matrix[batch_entry(i, j) + l] = A[lane](i, j);
        for (Index q = 0; q < Q; ++q) polynomial[batch_lanes * (q * n + i) + l] = G[lane](i, q);
        for (Index c = 0; c < count; ++c) right[batch_lanes * (c * n + i) + l] = s[lane](i, c);
      }
    }
    failed = batch_saddle({n, Q, count, matrix.data(), polynomial.data(), right.data(), pi.data(), work.data()});
  }

  // alpha above pi, as found and by LU.
  [[nodiscard]] Eigen::MatrixXd found(int l) const {
    Eigen::MatrixXd x(n + Q, count);
    for (Index c = 0; c < count; ++c) {
      for (Index i = 0; i < n; ++i) x(i, c) = right[batch_lanes * (c * n + i) + l];
      for (Index q = 0; q < Q; ++q) x(n + q, c) = pi[batch_lanes * (c * Q + q) + l];
    }
    return x;
  }
  [[nodiscard]] Eigen::MatrixXd expected(int l) const {
    const auto lane = static_cast<std::size_t>(l);
    Eigen::MatrixXd system = Eigen::MatrixXd::Zero(n + Q, n + Q);
    system.topLeftCorner(n, n) = A[lane];
    system.topRightCorner(n, Q) = G[lane];
    system.bottomLeftCorner(Q, n) = G[lane].transpose();
    Eigen::MatrixXd sides = Eigen::MatrixXd::Zero(n + Q, count);
    sides.topRows(n) = s[lane];
    return system.fullPivLu().solve(sides);
  }
};

TEST(BatchSaddle, SolvesEightSystemsLikeADecompositionOfTheWholeMatrix) {
  for (const Index Q : {0, 1, 3, 6}) {
    for (const Index n : {Q + 1, Q + 2, Index{9}, Index{20}}) {
      for (const Index count : {1, 3}) {
        Systems systems(n, Q, count, 7);
        systems.solve();
        EXPECT_EQ(systems.failed, 0U);
        for (int l = 0; l < batch_lanes; ++l) {
          const Eigen::MatrixXd x = systems.expected(l);
          EXPECT_LT((systems.found(l) - x).norm(), rounding * (1 + x.norm()))
              << "n " << n << " Q " << Q << " lane " << l;
        }
      }
    }
  }
}

TEST(BatchSaddle, IsThePolynomialThroughAsManyPointsAsItHasCoefficients) {
  Systems systems(4, 4, 2, 3);
  systems.solve();
  EXPECT_EQ(systems.failed, 0U);
  for (int l = 0; l < batch_lanes; ++l) {
    EXPECT_EQ(systems.found(l).topRows(4).norm(), 0);
    const Eigen::MatrixXd x = systems.expected(l);
    EXPECT_LT((systems.found(l) - x).norm(), rounding * (1 + x.norm()));
  }
}

TEST(BatchSaddle, NamesTheLanesThatFailAndSolvesTheOthers) {
  Systems systems(12, 3, 1, 5);
  systems.G[2].col(2) = systems.G[2].col(0) - 2 * systems.G[2].col(1);  // linearly dependent
  systems.A[6] = -Eigen::MatrixXd::Identity(12, 12);                    // negative
  systems.solve();
  EXPECT_EQ(systems.failed, 1U << 2 | 1U << 6);
  for (const int l : {0, 1, 3, 4, 5, 7}) {
    const Eigen::MatrixXd x = systems.expected(l);
    EXPECT_LT((systems.found(l) - x).norm(), rounding * (1 + x.norm()));
  }
}

}  // namespace
}  // namespace csrbf::batched_saddle_test
