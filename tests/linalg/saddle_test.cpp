#include "csrbf/linalg/saddle.hpp"

#include "csrbf/core/error.hpp"

#include <gtest/gtest.h>
#include <Eigen/LU>

#include <cmath>
#include <random>

namespace csrbf::saddle_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double rounding = 1e-11;  // roundings times the condition of the systems below, up to some 10^4

// Scattered data in the plane with a kernel r -> phi and the monomials 1, x, y: G empty for positive definite kernels.
struct Problem {
  MatrixXd A;
  MatrixXd G;
  MatrixXd s;
  VectorXd weights;
};

enum class KernelOrder { positive_definite, conditional };

Problem make_problem(KernelOrder order, Index n, double noise = 0) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> normal(0, 1);
  MatrixXd x(2, n);
  for (double& value : x.reshaped()) value = uniform(random);
  Problem p{MatrixXd(n, n), MatrixXd(n, 0), MatrixXd(n, 2), VectorXd(n)};
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) {
      const double r = (x.col(i) - x.col(j)).norm();
      p.A(i, j) = order == KernelOrder::positive_definite ? (1 + 5 * r) * std::exp(-5 * r) : r * r * r;
    }
    p.s(i, 0) = std::sin(4 * x(0, i)) + x(1, i) + noise * normal(random);
    p.s(i, 1) = x(0, i) * x(1, i) + noise * normal(random);
    p.weights[i] = .2 + uniform(random);
  }
  if (order == KernelOrder::conditional) {
    p.G.resize(n, 3);
    p.G << VectorXd::Ones(n), x.transpose();
  }
  return p;
}

// The whole system by LU: [alpha; pi].
MatrixXd brute_force(const Problem& p, double lambda) {
  const Index n = p.A.rows();
  const Index Q = p.G.cols();
  MatrixXd K = MatrixXd::Zero(n + Q, n + Q);
  K.topLeftCorner(n, n) = p.A;
  K.topLeftCorner(n, n).diagonal() += lambda * p.weights.cwiseInverse();
  K.topRightCorner(n, Q) = p.G;
  K.bottomLeftCorner(Q, n) = p.G.transpose();
  MatrixXd b = MatrixXd::Zero(n + Q, p.s.cols());
  b.topRows(n) = p.s;
  return Eigen::FullPivLU<MatrixXd>(K).solve(b);
}

Problem without(const Problem& p, Index k) {
  std::vector<Index> rest;
  for (Index i = 0; i < p.A.rows(); ++i)
    if (i != k) rest.push_back(i);
  return {p.A(rest, rest), p.G(rest, Eigen::all), p.s(rest, Eigen::all), p.weights(rest)};
}

MatrixXd brute_force_errors(const Problem& p, double lambda) {
  MatrixXd errors(p.s.rows(), p.s.cols());
  for (Index k = 0; k < p.s.rows(); ++k) {
    const MatrixXd rest = brute_force(without(p, k), lambda);
    std::vector<Index> others;
    for (Index i = 0; i < p.A.rows(); ++i)
      if (i != k) others.push_back(i);
    VectorXd row(rest.rows());
    row << p.A.row(k)(others).transpose(), p.G.row(k).transpose();
    errors.row(k) = p.s.row(k) - row.transpose() * rest;
  }
  return errors;
}

TEST(Saddle, OfTheIdentityDividesByOnePlusLambdaOverTheWeight) {
  const MatrixXd A = MatrixXd::Identity(3, 3);
  const MatrixXd s = VectorXd::LinSpaced(3, 1, 3);
  const SaddleSolution solution =
      solve_saddle(A, MatrixXd(3, 0), s, {.lambda = 2, .weights = Eigen::Vector3d(1, 2, 4)});
  EXPECT_TRUE(solution.alpha.isApprox(Eigen::Vector3d(1. / 3, 2. / 2, 3. / 1.5), 1e-15));
  EXPECT_TRUE(solution.leave_one_out.isApprox(s, 1e-15));  // nothing connects the points
}

TEST(Saddle, SolvesTheWholeSystem) {
  for (const KernelOrder order : {KernelOrder::positive_definite, KernelOrder::conditional}) {
    for (const double lambda : {0.0, .01}) {
      const Problem p = make_problem(order, 40);
      const SaddleSolution solution = solve_saddle(p.A, p.G, p.s, {.lambda = lambda, .weights = p.weights});
      const MatrixXd expected = brute_force(p, lambda);
      EXPECT_TRUE(solution.alpha.isApprox(expected.topRows(40), rounding));
      ASSERT_EQ(solution.pi.rows(), p.G.cols());
      EXPECT_LE((solution.pi - expected.bottomRows(p.G.cols())).norm(), rounding * expected.norm());
    }
  }
}

TEST(Saddle, ReadsTheLowerTriangleOnly) {
  const Problem p = make_problem(KernelOrder::conditional, 20);
  MatrixXd lower = p.A;
  lower.triangularView<Eigen::StrictlyUpper>().setConstant(17);
  EXPECT_TRUE(solve_saddle(lower, p.G, p.s).alpha.isApprox(solve_saddle(p.A, p.G, p.s).alpha, 1e-14));
}

TEST(Saddle, LeaveOneOutErrorsAreThoseOfLeavingOneOut) {
  for (const KernelOrder order : {KernelOrder::positive_definite, KernelOrder::conditional}) {
    for (const double lambda : {0.0, .003}) {
      const Problem p = make_problem(order, 30);
      const SaddleSolution solution = solve_saddle(p.A, p.G, p.s, {.lambda = lambda, .weights = p.weights});
      EXPECT_LT((solution.leave_one_out - brute_force_errors(p, lambda)).cwiseAbs().maxCoeff(), rounding);
    }
  }
}

TEST(Saddle, ReproducesPolynomialsWithoutTheKernel) {
  Problem p = make_problem(KernelOrder::conditional, 25);
  p.s = p.G * MatrixXd::Random(3, 2);
  const SaddleSolution solution = solve_saddle(p.A, p.G, p.s, {.lambda = .1});
  EXPECT_LT(solution.alpha.cwiseAbs().maxCoeff(), rounding);
  EXPECT_LT(solution.leave_one_out.cwiseAbs().maxCoeff(), rounding);
}

TEST(Saddle, AsManyPolynomialsAsPointsInterpolateAlone) {
  const Problem p = make_problem(KernelOrder::conditional, 3);
  const SaddleSolution solution = solve_saddle(p.A, p.G, p.s);
  EXPECT_EQ(solution.alpha.cwiseAbs().maxCoeff(), 0);
  EXPECT_TRUE((p.G * solution.pi).isApprox(p.s, rounding));
  EXPECT_EQ(solution.leave_one_out(0, 0), std::numeric_limits<double>::infinity());
}

TEST(Saddle, OfManyUnknownsHasTheSameErrors) {
  const Problem p = make_problem(KernelOrder::conditional, 150);
  EXPECT_LT(
      (solve_saddle(p.A, p.G, p.s, {.lambda = .01, .weights = p.weights}).leave_one_out - brute_force_errors(p, .01))
          .cwiseAbs()
          .maxCoeff(),
      rounding);
}

// Gaussians of a support of 50 spacings: the matrix has numerical rank 10.
TEST(Saddle, RescuesSingularSystemsByTheSmallestLambdaThatWorks) {
  const Index n = 40;
  const VectorXd x = VectorXd::LinSpaced(n, 0, 1);
  const MatrixXd A = (-(x.replicate(1, n) - x.transpose().replicate(n, 1)).array().square()).exp();
  const MatrixXd s = (3 * x).array().sin();
  EXPECT_THROW((void)solve_saddle(A, MatrixXd(n, 0), s), SolverFailure);
  const SaddleSolution solution = solve_saddle(A, MatrixXd(n, 0), s, {.largest_rescue = 1e-8});
  EXPECT_GT(solution.lambda, 0);
  EXPECT_LT(solution.lambda, 1e-13);
  EXPECT_LT((A * solution.alpha - s).cwiseAbs().maxCoeff(), 1e-7);
  EXPECT_LT(solution.leave_one_out.cwiseAbs().maxCoeff(), 1e-6);
}

TEST(Saddle, ScalingAllWeightsScalesLambda) {
  const Problem p = make_problem(KernelOrder::conditional, 25);
  const SaddleSolution one = solve_saddle(p.A, p.G, p.s, {.lambda = .1, .weights = p.weights});
  const SaddleSolution other = solve_saddle(p.A, p.G, p.s, {.lambda = 1, .weights = 10 * p.weights});
  EXPECT_TRUE(one.alpha.isApprox(other.alpha, rounding));
}

// The scores recomputed from their definitions, at the choice and next to it.
double score(const Problem& p, double lambda, LambdaCriterion criterion) {
  const SaddleSolution solution = solve_saddle(p.A, p.G, p.s, {.lambda = lambda, .weights = p.weights});
  const VectorXd root = p.weights.cwiseSqrt();
  if (criterion == LambdaCriterion::leave_one_out)
    return std::sqrt((root.asDiagonal() * solution.leave_one_out).squaredNorm() / (2 * p.weights.sum()));
  Problem unit = p;  // residuals of unit data: the columns of I - S
  unit.s = MatrixXd::Identity(p.A.rows(), p.A.rows());
  const MatrixXd fits = unit.A * brute_force(unit, lambda).topRows(p.A.rows()) +
                        unit.G * brute_force(unit, lambda).bottomRows(p.G.cols());
  const auto n = static_cast<double>(p.A.rows());
  const MatrixXd residual = root.asDiagonal() * (p.s - fits * p.s);
  return residual.squaredNorm() / (2 * n) / std::pow(1 - fits.trace() / n, 2);
}

TEST(ChooseSmoothing, MinimisesTheCriterion) {
  for (const KernelOrder order : {KernelOrder::positive_definite, KernelOrder::conditional}) {
    for (const auto criterion : {LambdaCriterion::leave_one_out, LambdaCriterion::generalized_cross_validation}) {
      const Problem p = make_problem(order, 60, .1);
      const SmoothingChoice choice = choose_smoothing(p.A, p.G, p.s, {.criterion = criterion, .weights = p.weights});
      const double best = score(p, choice.lambda, criterion);
      const double reported = criterion == LambdaCriterion::leave_one_out ? choice.leave_one_out : choice.gcv;
      EXPECT_NEAR(reported / best, 1, 1e-8);
      for (const double factor : {1e-4, .03, .7, 1.4, 30., 1e4})
        EXPECT_GE(score(p, factor * choice.lambda, criterion), best * (1 - 1e-6)) << factor;
    }
  }
}

TEST(ChooseSmoothing, SmoothsNoiseAndKeepsExactData) {
  const Problem exact = make_problem(KernelOrder::conditional, 80);
  const Problem noisy = make_problem(KernelOrder::conditional, 80, .3);
  const SmoothingChoice none = choose_smoothing(exact.A, exact.G, exact.s);
  const SmoothingChoice much = choose_smoothing(noisy.A, noisy.G, noisy.s);
  EXPECT_GT(none.free_parameters, 60);
  EXPECT_LT(much.free_parameters, 30);
  EXPECT_GE(much.free_parameters, 3);
}

TEST(ChooseSmoothing, LeavesOfPureNoiseThePolynomial) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise;
  for (const double overlap : {0., .01}) {  // of radial functions, so narrow that all lambdas predict about as well
    MatrixXd A = MatrixXd::Identity(200, 200);
    A.diagonal(1).setConstant(overlap);
    A.diagonal(-1).setConstant(overlap);
    MatrixXd s(200, 1);
    for (double& value : s.reshaped()) value = 5 + noise(random);
    EXPECT_NEAR(choose_smoothing(A, MatrixXd::Ones(200, 1), s).free_parameters, 1, .1) << overlap;
  }
}

template <class Exception, class Action>
std::string message_of(const Action& action) {
  try {
    action();
  } catch (const Exception& error) {
    return error.what();
  }
  return "nothing thrown";
}

TEST(Saddle, SaysThatPointsAreNotUnisolvent) {
  Problem p = make_problem(KernelOrder::conditional, 10);
  p.G.col(2) = 2 * p.G.col(1) + p.G.col(0);  // all points on a line
  const std::string expected =
      "solve_saddle: G = 10 x 3: has only rank 2: the points lie on the zero set of a polynomial of this degree; lower "
      "the degree or add points";
  EXPECT_EQ(message_of<InvalidInput>([&] { (void)solve_saddle(p.A, p.G, p.s); }), expected);
  EXPECT_THROW((void)choose_smoothing(p.A, p.G, p.s), InvalidInput);
}

TEST(Saddle, SaysThatEqualPointsNeedSmoothing) {
  const MatrixXd A = MatrixXd::Ones(4, 4);
  const MatrixXd s = VectorXd::LinSpaced(4, 0, 1);
  const std::string message = message_of<SolverFailure>([&] { (void)solve_saddle(A, MatrixXd(4, 0), s); });
  EXPECT_EQ(
      message.find("solve_saddle: the system is not positive definite to working precision with lambda = 0: give"), 0U);
  EXPECT_NO_THROW((void)solve_saddle(A, MatrixXd(4, 0), s, {.lambda = .1}));
}

TEST(Saddle, RejectsBadInput) {
  const Problem p = make_problem(KernelOrder::conditional, 10);
  const MatrixXd wide = MatrixXd::Random(10, 11);
  MatrixXd missing = p.s;
  missing(3, 1) = std::nan("");
  EXPECT_THROW((void)solve_saddle(p.A.topRows(9), p.G, p.s), InvalidInput);
  EXPECT_THROW((void)solve_saddle(p.A, p.G, p.s.topRows(9)), InvalidInput);
  EXPECT_THROW((void)solve_saddle(p.A, wide, p.s), InvalidInput);
  EXPECT_THROW((void)solve_saddle(p.A, p.G, missing), InvalidInput);
  EXPECT_THROW((void)solve_saddle(p.A, p.G, p.s, {.weights = VectorXd::Zero(10)}), InvalidInput);
  EXPECT_EQ(message_of<InvalidInput>([&] { (void)solve_saddle(p.A, p.G, p.s, {.lambda = -1}); }),
            "solve_saddle: lambda = -1: must be finite and not negative");
  EXPECT_THROW((void)choose_smoothing(p.A, p.G, p.s, {.smallest = 0}), InvalidInput);
  EXPECT_THROW((void)choose_smoothing(p.A, p.G, p.s, {.largest = 1e-20}), InvalidInput);
}

}  // namespace
}  // namespace csrbf::saddle_test
