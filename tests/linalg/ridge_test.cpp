#include "csrbf/linalg/ridge.hpp"

#include "csrbf/core/error.hpp"

#include <gtest/gtest.h>
#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>

#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

namespace csrbf::ridge_test {
namespace {

constexpr double rounding = 1e-12;  // well conditioned systems of order one

Eigen::MatrixXd random_matrix(Index rows, Index cols, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  return Eigen::MatrixXd::NullaryExpr(rows, cols, [&] { return uniform(random); });
}

std::vector<Index> all_but(Index k, Index count) {
  std::vector<Index> others;
  for (Index i = 0; i < count; ++i)
    if (i != k) others.push_back(i);
  return others;
}

// Gaussian bumps: positive definite, smooth.
Eigen::MatrixXd bumps(const Eigen::VectorXd& x, const Eigen::VectorXd& centers, double width) {
  return Eigen::MatrixXd::NullaryExpr(
      x.size(), centers.size(), [&](Index i, Index j) { return std::exp(-std::pow((x[i] - centers[j]) / width, 2)); });
}

// The options that give `lambda` in a problem with these weights and M coefficients.
RidgeOptions with_lambda(double lambda, const Eigen::VectorXd& weights, Index M) {
  return {.lambda0 = lambda * static_cast<double>(M) / weights.sum(), .weights = weights};
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

TEST(Ridge, ShrinksAMeanExactly) {
  const Eigen::MatrixXd B = Eigen::MatrixXd::Ones(2, 1);
  const RidgeFit fit = ridge(B, Eigen::Vector2d(1, 3), {.lambda0 = 1.0});
  // lambda = 1 * 2 / 1, c = 4 / (2 + 2), S_kk = 1 / 4; one datum alone gives s / (1 + 2).
  EXPECT_DOUBLE_EQ(fit.lambda, 2);
  EXPECT_NEAR(fit.coefficients(0), 1, rounding);
  EXPECT_NEAR(fit.hat_diagonal[0], .25, rounding);
  EXPECT_NEAR(fit.leave_one_out(0), 1 - 3.0 / 3, rounding);
  EXPECT_NEAR(fit.leave_one_out(1), 3 - 1.0 / 3, rounding);
  EXPECT_NEAR(fit.gcv, (0.0 + 4.0) / 2 / (.75 * .75), rounding);
}

TEST(Ridge, SolvesTheNormalEquations) {
  const Eigen::MatrixXd B = random_matrix(30, 7, 1);
  const Eigen::MatrixXd s = random_matrix(30, 2, 2);
  const Eigen::VectorXd weights = random_matrix(30, 1, 3).array() + 1.5;
  const RidgeFit fit = ridge(B, s, {.lambda0 = .1, .weights = weights});
  EXPECT_NEAR(fit.lambda, .1 * weights.sum() / 7, rounding);
  const Eigen::MatrixXd gram = B.transpose() * weights.asDiagonal() * B + fit.lambda * Eigen::MatrixXd::Identity(7, 7);
  const Eigen::MatrixXd inverse = gram.inverse();
  const Eigen::MatrixXd expected = inverse * B.transpose() * weights.asDiagonal() * s;
  EXPECT_LT((fit.coefficients - expected).norm(), rounding);
  EXPECT_LT((fit.fitted - B * expected).norm(), rounding);
  const Eigen::MatrixXd S = B * inverse * B.transpose() * weights.asDiagonal();
  EXPECT_LT((fit.hat_diagonal - S.diagonal()).norm(), rounding);
  const double residual = (weights.asDiagonal() * (s - fit.fitted).cwiseAbs2()).sum();
  EXPECT_NEAR(fit.gcv, residual / (30 * 2) / std::pow(1 - S.trace() / 30, 2), rounding);
}

TEST(Ridge, HasTheLeaveOneOutErrorsOfRefits) {
  constexpr Index M = 8;
  for (const Index N : {Index{5}, M, M + 1, Index{25}}) {
    const Eigen::MatrixXd B = random_matrix(N, M, 4);
    const Eigen::MatrixXd s = random_matrix(N, 2, 5);
    const Eigen::VectorXd weights = random_matrix(N, 1, 6).array() + 1.5;
    for (const double lambda : {1e-3, .3, 10.0}) {
      const RidgeFit fit = ridge(B, s, with_lambda(lambda, weights, M));
      double squares = 0;
      for (Index k = 0; k < N; ++k) {
        const std::vector<Index> others = all_but(k, N);
        const RidgeFit refit =
            ridge(B(others, Eigen::all), s(others, Eigen::all), with_lambda(lambda, weights(others), M));
        const Eigen::RowVectorXd expected = s.row(k) - B.row(k) * refit.coefficients;
        EXPECT_LT((fit.leave_one_out.row(k) - expected).norm(), rounding / std::min(lambda, 1.0));
        squares += weights[k] * expected.squaredNorm();
      }
      EXPECT_NEAR(fit.cross_validation_rmse, std::sqrt(squares / (2 * weights.sum())),
                  rounding / std::min(lambda, 1.0));
    }
  }
}

TEST(Ridge, WithoutRegularisationIsLeastSquaresByQr) {
  const Eigen::MatrixXd B = random_matrix(40, 9, 7);
  const Eigen::VectorXd s = random_matrix(40, 1, 8);
  const RidgeFit fit = ridge(B, s, {.lambda0 = 0.0});
  EXPECT_LT((fit.coefficients - B.colPivHouseholderQr().solve(s)).norm(), rounding);
  EXPECT_NEAR(fit.hat_diagonal.sum(), 9, rounding);
  const std::vector<Index> others = all_but(3, 40);
  const Eigen::VectorXd c = B(others, Eigen::all).colPivHouseholderQr().solve(s(others));
  EXPECT_NEAR(fit.leave_one_out(3), s[3] - B.row(3).dot(c), rounding);
}

TEST(Ridge, DoesNotSquareTheCondition) {
  // Monomials on [0, 1]: condition about 1e9; through B^T B nothing would be left of these coefficients.
  constexpr Index M = 12;
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(60, 0, 1);
  const Eigen::MatrixXd B =
      Eigen::MatrixXd::NullaryExpr(60, M, [&](Index i, Index j) { return std::pow(x[i], static_cast<double>(j)); });
  const Eigen::VectorXd expected = Eigen::VectorXd::Ones(M);
  const RidgeFit fit = ridge(B, B * expected, {.lambda0 = 0.0});
  EXPECT_LT((fit.coefficients - expected).norm(), 1e-5);  // condition times rounding, with room
  EXPECT_GT(((B.transpose() * B).ldlt().solve(B.transpose() * (B * expected)) - expected).norm(), 1e-4);
}

TEST(Ridge, CountsADatumOfWeightTwoTwice) {
  const Eigen::MatrixXd B = random_matrix(12, 5, 9);
  const Eigen::VectorXd s = random_matrix(12, 1, 10);
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(12);
  weights[3] = 2;
  weights[7] = 0;
  std::vector<Index> repeated = all_but(7, 12);
  repeated.push_back(3);
  const RidgeFit fit = ridge(B, s, {.lambda0 = .01, .weights = weights});
  const RidgeFit expected = ridge(B(repeated, Eigen::all), s(repeated), {.lambda0 = .01});
  EXPECT_LT((fit.coefficients - expected.coefficients).norm(), rounding);
  EXPECT_NEAR(fit.lambda, expected.lambda, rounding);
  EXPECT_EQ(fit.hat_diagonal[7], 0);
  EXPECT_NEAR(fit.leave_one_out(7), s[7] - (B.row(7) * expected.coefficients).value(), rounding);
}

TEST(Ridge, HasARegularisationThatDoesNotDependOnTheNumberOfData) {
  const Eigen::MatrixXd B = random_matrix(20, 6, 11);
  const Eigen::VectorXd s = random_matrix(20, 1, 12);
  const RidgeFit once = ridge(B, s, {.lambda0 = .05});
  const RidgeFit thrice = ridge(B.replicate(3, 1), s.replicate(3, 1), {.lambda0 = .05});
  EXPECT_LT((once.coefficients - thrice.coefficients).norm(), rounding);
}

TEST(Ridge, ReportsAnInfiniteErrorForADatumThatNothingElsePredicts) {
  Eigen::MatrixXd B = Eigen::MatrixXd::Zero(4, 2);
  B(0, 0) = 1;
  B.col(1).tail(3).setOnes();
  const RidgeFit fit = ridge(B, Eigen::Vector4d(5, 1, 2, 3), {.lambda0 = 0.0});
  EXPECT_EQ(fit.leave_one_out(0), std::numeric_limits<double>::infinity());
  EXPECT_NEAR(fit.leave_one_out(1), 1 - 2.5, rounding);
}

// Samples of a wave with noise, and how far from the wave a fit is.
struct NoisyWave {
  Eigen::VectorXd x;
  Eigen::VectorXd truth;
  Eigen::VectorXd data;

  explicit NoisyWave(unsigned seed) : x(Eigen::VectorXd::LinSpaced(120, 0, 1)), truth(x.size()), data(x.size()) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> noise(0, .1);
    for (Index i = 0; i < x.size(); ++i) {
      truth[i] = std::sin(2 * std::numbers::pi * x[i]) + .5 * std::cos(9 * x[i]);
      data[i] = truth[i] + noise(random);
    }
  }
  [[nodiscard]] double error(const RidgeFit& fit) const { return (fit.fitted - truth).norm(); }
};

class ChosenLambda : public testing::TestWithParam<LambdaCriterion> {};

TEST_P(ChosenLambda, IsNearlyTheBestOneForANoisySignal) {
  double chosen = 0;
  double best = 0;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const NoisyWave wave(seed);
    const Eigen::MatrixXd B = bumps(wave.x, Eigen::VectorXd::LinSpaced(40, 0, 1), .1);
    chosen += wave.error(ridge(B, wave.data, {.criterion = GetParam()}));
    double smallest = std::numeric_limits<double>::infinity();
    for (double exponent = -12; exponent <= 2; exponent += .5)
      smallest = std::min(smallest, wave.error(ridge(B, wave.data, {.lambda0 = std::pow(10, exponent)})));
    best += smallest;
  }
  EXPECT_LT(chosen, 1.1 * best);
}

TEST_P(ChosenLambda, HasTheSmallestScoreOfAFineGrid) {
  const NoisyWave wave(3);
  const Eigen::MatrixXd B = bumps(wave.x, Eigen::VectorXd::LinSpaced(40, 0, 1), .1);
  const auto score = [](const RidgeFit& fit) {
    return GetParam() == LambdaCriterion::leave_one_out ? std::pow(fit.cross_validation_rmse, 2) : fit.gcv;
  };
  const double chosen = score(ridge(B, wave.data, {.criterion = GetParam()}));
  constexpr double flat = 1e-6;  // the score is flat at its minimum
  for (double exponent = -14; exponent <= 2; exponent += .25)
    EXPECT_LT(chosen, (1 + flat) * score(ridge(B, wave.data, {.lambda0 = std::pow(10, exponent)})));
}

TEST_P(ChosenLambda, IsSmallForDataWithoutNoiseAndStaysInItsRange) {
  const NoisyWave wave(3);
  const Eigen::MatrixXd B = bumps(wave.x, Eigen::VectorXd::LinSpaced(40, 0, 1), .1);
  EXPECT_LT(ridge(B, wave.truth, {.criterion = GetParam()}).lambda0, 1e-8);
  const RidgeFit bounded = ridge(B, wave.truth, {.criterion = GetParam(), .smallest = 1e-3, .largest = 1e-1});
  EXPECT_GE(bounded.lambda0, 1e-3 * (1 - rounding));
  EXPECT_LE(bounded.lambda0, 1e-3 * 1.01);
}

TEST_P(ChosenLambda, OfAKernelIsNearlyTheBestOneForANoisySignal) {
  const NoisyWave wave(5);
  const Eigen::MatrixXd A = bumps(wave.x, wave.x, .2);
  double best = std::numeric_limits<double>::infinity();
  for (double exponent = -10; exponent <= 2; exponent += .5)
    best = std::min(best, wave.error(kernel_ridge(A, wave.data, {.lambda0 = std::pow(10, exponent)})));
  EXPECT_LT(wave.error(kernel_ridge(A, wave.data, {.criterion = GetParam()})), 1.1 * best);
}

INSTANTIATE_TEST_SUITE_P(ByEveryCriterion, ChosenLambda,
                         testing::Values(LambdaCriterion::generalized_cross_validation,
                                         LambdaCriterion::leave_one_out));

TEST(KernelRidge, InterpolatesWithoutRegularisation) {
  const Eigen::MatrixXd R = random_matrix(15, 15, 13);
  const Eigen::MatrixXd A = R * R.transpose() + Eigen::MatrixXd::Identity(15, 15);
  const Eigen::MatrixXd s = random_matrix(15, 2, 14);
  const RidgeFit fit = kernel_ridge(A, s, {.lambda0 = 0.0});
  EXPECT_LT((A * fit.coefficients - s).norm(), rounding);
  EXPECT_LT((fit.fitted - s).norm(), rounding);
  EXPECT_NEAR(fit.hat_diagonal.minCoeff(), 1, rounding);
}

TEST(KernelRidge, HasTheLeaveOneOutErrorsOfRefits) {
  constexpr Index N = 15;
  const Eigen::MatrixXd R = random_matrix(N, N, 15);
  const Eigen::MatrixXd A = R * R.transpose() + Eigen::MatrixXd::Identity(N, N);
  const Eigen::MatrixXd s = random_matrix(N, 2, 16);
  const Eigen::VectorXd weights = random_matrix(N, 1, 17).array() + 1.5;
  for (const double lambda0 : {0.0, 1e-3, 1.0}) {
    const RidgeFit fit = kernel_ridge(A, s, {.lambda0 = lambda0, .weights = weights});
    EXPECT_NEAR(fit.lambda, lambda0 * A.trace() / N, rounding);
    Eigen::MatrixXd regularised = A;
    regularised.diagonal() += fit.lambda * weights.cwiseInverse();
    EXPECT_LT((regularised * fit.coefficients - s).norm(), rounding * 10);
    for (Index k = 0; k < N; ++k) {
      const std::vector<Index> others = all_but(k, N);
      const Eigen::MatrixXd c = regularised(others, others).ldlt().solve(s(others, Eigen::all));
      const Eigen::RowVectorXd expected = s.row(k) - A(k, others) * c;
      EXPECT_LT((fit.leave_one_out.row(k) - expected).norm(), rounding * 10);
    }
  }
}

TEST(KernelRidge, ReadsTheLowerTriangle) {
  Eigen::Matrix2d A;
  A << 2, 99, 1, 2;
  const RidgeFit fit = kernel_ridge(A, Eigen::Vector2d(3, 3), {.lambda0 = 0.0});
  EXPECT_LT((fit.coefficients - Eigen::Vector2d(1, 1)).norm(), rounding);
}

TEST(KernelRidge, ReportsAMatrixThatIsNotPositiveDefinite) {
  const Eigen::Matrix2d equal = Eigen::Matrix2d::Ones();
  EXPECT_THROW(kernel_ridge(equal, Eigen::Vector2d(1, 2), {.lambda0 = 0.0}), SolverFailure);
  EXPECT_NO_THROW(kernel_ridge(equal, Eigen::Vector2d(1, 2), {.lambda0 = 1e-6}));
  Eigen::Matrix2d indefinite;
  indefinite << 1, 2, 2, 1;
  EXPECT_EQ(
      message_of([&] { kernel_ridge(indefinite, Eigen::Vector2d(1, 2), {.lambda0 = .5}); }),
      "kernel_ridge: A + lambda W^-1 is not positive definite, its smallest eigenvalue is -0.5: increase lambda0 = "
      "0.5, merge coincident points, or use a kernel that is positive definite in this dimension");
  EXPECT_GT(kernel_ridge(indefinite, Eigen::Vector2d(1, 2)).lambda, 1);
}

TEST(Ridge, ReportsDependentColumnsWhenThereIsNoRegularisation) {
  Eigen::MatrixXd B = random_matrix(10, 3, 18);
  B.col(2).setZero();
  EXPECT_EQ(message_of([&] { ridge(B, Eigen::VectorXd::Ones(10), {.lambda0 = 0.0}); }),
            "ridge: the 3 columns of B have only rank 2: give lambda0 > 0, or leave out columns without data");
  EXPECT_THROW(ridge(B.topRows(2), Eigen::VectorXd::Ones(2), {.lambda0 = 0.0}), SolverFailure);
  EXPECT_EQ(ridge(B, Eigen::VectorXd::Ones(10), {.lambda0 = 1e-3}).coefficients(2), 0);
}

TEST(Ridge, RejectsInputThatMakesNoSense) {
  const Eigen::MatrixXd B = random_matrix(4, 2, 19);
  const Eigen::VectorXd s = Eigen::VectorXd::Ones(4);
  EXPECT_THROW(ridge(Eigen::MatrixXd(0, 2), Eigen::VectorXd(0)), InvalidInput);
  EXPECT_THROW(ridge(B, s.head(3)), InvalidInput);
  EXPECT_THROW(ridge(B, s, {.weights = s.head(3)}), InvalidInput);
  EXPECT_THROW(ridge(B, s, {.weights = -s}), InvalidInput);
  EXPECT_THROW(ridge(B, s, {.weights = 0 * s}), InvalidInput);
  EXPECT_THROW(ridge(B, s, {.lambda0 = std::numeric_limits<double>::quiet_NaN()}), InvalidInput);
  EXPECT_THROW(ridge(B, s, {.smallest = 1, .largest = .5}), InvalidInput);
  EXPECT_THROW(ridge(B, s, {.smallest = 0}), InvalidInput);
  EXPECT_THROW(ridge(B, std::numeric_limits<double>::infinity() * s), InvalidInput);
  EXPECT_THROW(kernel_ridge(B, s), InvalidInput);
  EXPECT_THROW(kernel_ridge(B.topRows(2), s.head(2), {.weights = Eigen::Vector2d(1, 0)}), InvalidInput);
  EXPECT_EQ(message_of([&] { ridge(B, s, {.lambda0 = -1.0}); }),
            "ridge: lambda0 = -1: must be finite and not negative; leave it out to have it chosen");
}

}  // namespace
}  // namespace csrbf::ridge_test
