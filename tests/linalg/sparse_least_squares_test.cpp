#include "csrbf/linalg/sparse_least_squares.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/linalg/ridge.hpp"

#include <gtest/gtest.h>
#include <Eigen/QR>

#include <random>

namespace csrbf::sparse_least_squares_test {
namespace {

using Sparse = Eigen::SparseMatrix<double, Eigen::RowMajor>;

constexpr double solved = 1e-9;  // well conditioned problems of some hundred unknowns

Eigen::MatrixXd random_matrix(Index rows, Index columns, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
}

// Overlapping hats on a line: N samples, M centres.
Sparse hats(Index n, Index m, double width = 3) {
  Eigen::MatrixXd B(n, m);
  for (Index k = 0; k < n; ++k)
    for (Index j = 0; j < m; ++j) {
      const double x = static_cast<double>(k) / static_cast<double>(n - 1) * static_cast<double>(m - 1);
      B(k, j) = std::max(0.0, 1 - std::abs(x - static_cast<double>(j)) / width);
    }
  return B.sparseView();
}

Eigen::VectorXd random_weights(Index n) {
  return random_matrix(n, 1, 9).cwiseAbs2();
}

TEST(SparseLeastSquares, SolvesTwoEquationsByHand) {
  const Sparse B = Eigen::MatrixXd::Ones(2, 1).sparseView();
  const auto fit = sparse_least_squares(B, Eigen::Vector2d(1, 3), {.lambda0 = .5});
  // lambda = .5 * 2 / 1, (2 + lambda) c = 4
  EXPECT_NEAR(fit.coefficients(0), 4. / 3, 1e-15);
  EXPECT_EQ(fit.lambda, 1);
}

TEST(SparseLeastSquares, AgreesWithDenseRidgeRegression) {
  const Sparse B = hats(200, 30);
  const Eigen::MatrixXd s = random_matrix(200, 3, 1);
  for (const double lambda0 : {1e-10, 1e-4, 1.0}) {
    for (const bool weighted : {false, true}) {
      const Eigen::VectorXd weights = weighted ? random_weights(200) : Eigen::VectorXd();
      const auto sparse = sparse_least_squares(B, s, {.lambda0 = lambda0, .weights = weights});
      const auto dense = ridge(Eigen::MatrixXd(B), s, {.lambda0 = lambda0, .weights = weights});
      EXPECT_LT((sparse.coefficients - dense.coefficients).norm(), solved * dense.coefficients.norm());
      EXPECT_LT((sparse.fitted - dense.fitted).norm(), solved * dense.fitted.norm());
    }
  }
}

TEST(SparseLeastSquares, AgreesWithTheQrFactorisationOfAnIllConditionedProblem) {
  const Sparse B = hats(400, 60, 12);
  const Eigen::VectorXd s = random_matrix(400, 1, 1);
  const auto fit = sparse_least_squares(B, s, {.lambda0 = 1e-12});
  Eigen::MatrixXd stacked(460, 60);
  stacked << Eigen::MatrixXd(B), std::sqrt(fit.lambda) * Eigen::MatrixXd::Identity(60, 60);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(460);
  right.head(400) = s;
  const Eigen::VectorXd expected = stacked.colPivHouseholderQr().solve(right);
  EXPECT_LT((fit.coefficients.col(0) - expected).norm(), 1e-7 * expected.norm());
}

TEST(SparseLeastSquares, MinimisesTheSumWithAGivenPenalty) {
  const Sparse B = hats(100, 20);
  const Eigen::VectorXd s = random_matrix(100, 1, 1);
  const Eigen::MatrixXd root = random_matrix(20, 20, 2);
  const Eigen::MatrixXd P = root * root.transpose() + Eigen::MatrixXd::Identity(20, 20);
  const auto fit = sparse_least_squares(B, s, {.lambda0 = .01, .penalty = P.sparseView()});
  EXPECT_NEAR(fit.lambda, .01 * 100 / P.trace(), 1e-15);
  const Eigen::VectorXd gradient = B.transpose() * (B * fit.coefficients - s) + fit.lambda * P * fit.coefficients;
  EXPECT_LT(gradient.norm(), solved);
}

TEST(SparseLeastSquares, SolvesIterativelyWhatItSolvesDirectly) {
  const Sparse B = hats(600, 200);
  const Eigen::MatrixXd s = random_matrix(600, 2, 1);
  const auto direct = sparse_least_squares(B, s, {.lambda0 = 1e-4});
  const auto iterative = sparse_least_squares(B, s, {.lambda0 = 1e-4, .solver = {.method = SparseMethod::iterative}});
  EXPECT_TRUE(direct.direct);
  EXPECT_EQ(direct.iterations, 0);
  EXPECT_FALSE(iterative.direct);
  EXPECT_GT(iterative.iterations, 0);
  EXPECT_LT((direct.coefficients - iterative.coefficients).norm(), solved * direct.coefficients.norm());
  const auto chosen = sparse_least_squares(B, s, {.lambda0 = 1e-4, .solver = {.direct_flops = 10}});
  EXPECT_FALSE(chosen.direct);
}

TEST(SparseLeastSquares, LeavesOutColumnsWithoutData) {
  Eigen::MatrixXd B = Eigen::MatrixXd(hats(50, 10));
  B.col(3).setZero();
  B.col(7).setZero();
  const Eigen::VectorXd s = random_matrix(50, 1, 1);
  const auto fit = sparse_least_squares(B.sparseView(), s, {.lambda0 = 0});
  EXPECT_EQ(fit.dropped, 2);
  EXPECT_EQ(fit.coefficients(3), 0);
  EXPECT_EQ(fit.coefficients(7), 0);
  EXPECT_LT((B.transpose() * (B * fit.coefficients - s)).norm(), solved);
  const auto nothing = sparse_least_squares(Sparse(5, 3), Eigen::VectorXd::Ones(5), {.lambda0 = 0});
  EXPECT_EQ(nothing.dropped, 3);
  EXPECT_EQ(nothing.fitted.norm(), 0);
}

TEST(SparseLeastSquares, ChoosesTheRegularisationThatDenseCrossValidationChooses) {
  for (const Index m : {Index{80}, Index{400}}) {  // traces exact and estimated
    const Index n = 2 * m;
    const Sparse B = hats(n, m, 8);
    Eigen::VectorXd s = .3 * random_matrix(n, 1, 1);
    for (Index k = 0; k < n; ++k) s[k] += std::sin(12 * static_cast<double>(k) / static_cast<double>(n));
    const auto sparse = sparse_least_squares(B, s);
    const auto dense = ridge(Eigen::MatrixXd(B), s);
    EXPECT_LT(sparse.gcv, 1.05 * dense.gcv);
    EXPECT_GT(sparse.gcv, .9 * dense.gcv);
    EXPECT_LT(std::abs(std::log10(sparse.lambda0 / dense.lambda0)), .5);
  }
}

// A model that is too large by as much as lambda is small: errors count in units of 1 + l . c.
TEST(SparseLeastSquares, ScoresTheRegularisationInTheGivenUnit) {
  const Sparse B = hats(160, 80, 8);
  const Eigen::VectorXd s = random_matrix(160, 1, 1).array() - 1;
  const AffineFunction unit{1, Eigen::VectorXd::Constant(80, 0.03)};
  const auto score = [&](double lambda0) {
    const auto fit = ridge(Eigen::MatrixXd(B), s, {.lambda0 = lambda0});
    const double u = unit.offset + unit.slope.dot(fit.coefficients.col(0));
    return u > 0 ? fit.gcv / (u * u) : std::numeric_limits<double>::infinity();
  };
  double best = std::numeric_limits<double>::infinity();
  for (double exponent = -12; exponent <= 2; exponent += 0.125) best = std::min(best, score(std::pow(10, exponent)));
  const auto chosen = sparse_least_squares(B, s, {.score_unit = unit});
  EXPECT_LT(chosen.gcv, 1.001 * best);
  EXPECT_NEAR(chosen.gcv, score(chosen.lambda0), 1e-6 * best);
  EXPECT_GT(chosen.lambda0, 2 * sparse_least_squares(B, s).lambda0);
  const auto halves = sparse_least_squares(B, s, {.score_unit = {2, {}}});
  EXPECT_NEAR(4 * halves.gcv, sparse_least_squares(B, s).gcv, 1e-12);
}

template <class Action>
std::string message_of(const Action& action) {
  try {
    action();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "nothing thrown";
}

TEST(SparseLeastSquares, RefusesWhatHasNoSolution) {
  const Sparse B = hats(20, 5);
  const Eigen::VectorXd s = Eigen::VectorXd::Ones(20);
  EXPECT_EQ(message_of([&] { sparse_least_squares(B, s.head(3)); }),
            "sparse_least_squares: s = 3: there must be one row of data per row of B");
  EXPECT_EQ(message_of([&] { sparse_least_squares(B, s * std::nan("")); }),
            "sparse_least_squares: s = NaN or infinity: every datum must be finite");
  EXPECT_EQ(message_of([&] { sparse_least_squares(B, s, {.lambda0 = -1}); }),
            "sparse_least_squares: lambda0 = -1: must be finite and not negative");
  EXPECT_EQ(message_of([&] { sparse_least_squares(B, s, {.weights = -s}); }),
            "sparse_least_squares: weights = negative or not finite: weights must be finite and not negative");
  EXPECT_EQ(message_of([&] { sparse_least_squares(B, s, {.weights = 0 * s}); }),
            "sparse_least_squares: weights = all zero: at least one must be positive");
  EXPECT_EQ(
      message_of([&] {
        sparse_least_squares(B, s, {.score_unit = {1, s}});
      }),
      "sparse_least_squares: score_unit.slope = 20: must have one entry per column of B, for data of one component");
  const Sparse twice = Eigen::MatrixXd::Ones(20, 2).sparseView();
  EXPECT_EQ(message_of([&] { sparse_least_squares(twice, s, {.lambda0 = 0}); }),
            "sparse_least_squares: the columns of B are linearly dependent to working precision; use more "
            "regularisation, fewer centres or smaller supports");
}

}  // namespace
}  // namespace csrbf::sparse_least_squares_test
