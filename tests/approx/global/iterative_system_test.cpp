#include "csrbf/approx/global/iterative_system.hpp"

#include "csrbf/approx/basis/polynomial_block.hpp"
#include "csrbf/approx/global/inverse_factor.hpp"
#include "csrbf/core/error.hpp"
#include "csrbf/linalg/saddle.hpp"

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include <random>

namespace csrbf::iterative_system_test {
namespace {

template <int Dim>
Points<Dim> cloud(Index n, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  return Points<Dim>::NullaryExpr(Dim, n, [&] { return uniform(random); });
}

template <int Dim>
Eigen::MatrixXd wave(const Points<Dim>& x) {
  return ((5 * x.row(0).array()).sin() * (4 * x.row(Dim - 1).array()).cos() + .2 * x.row(0).array()).transpose();
}

template <int Dim>
Eigen::MatrixXd polynomials(const Points<Dim>& x, int degree) {
  return polynomial_block<Dim>(x, degree, RankDeficiency::reduce).G;
}

template <int Dim>
Eigen::MatrixXd dense(const Points<Dim>& x, const Kernel& kernel, double support) {
  return RadialBasis<Dim>(kernel, x, Eigen::VectorXd::Constant(1, support)).dense_matrix(x);
}

// Against the dense system.
template <int Dim>
void check(const Kernel& kernel, double support, const Points<Dim>& x, double noise, int most_iterations,
           double tolerance = 1e-9) {
  const Eigen::MatrixXd G = polynomials<Dim>(x, std::max(kernel.order() - 1, 0));
  const Eigen::MatrixXd s = wave<Dim>(x);
  const Eigen::VectorXd D = Eigen::VectorXd::Constant(x.cols(), noise);
  const IterativeSolution fast = solve_iteratively<Dim>(x, kernel, support, D, G, s, {.tolerance = tolerance});
  Eigen::MatrixXd A = dense<Dim>(x, kernel, support);
  A.diagonal() += D;
  const Eigen::VectorXd residual = A * fast.alpha + G * fast.pi - s;
  EXPECT_LE(residual.cwiseAbs().maxCoeff(), 1.1 * tolerance * s.cwiseAbs().maxCoeff()) << kernel.name() << ' ' << Dim;
  EXPECT_LT((G.transpose() * fast.alpha).norm(), 1e-9 * fast.alpha.norm()) << kernel.name() << ' ' << Dim;
  EXPECT_LE(fast.iterations, most_iterations) << kernel.name() << ' ' << Dim;
}

TEST(IterativeSystem, SolvesKernelsOfAllOrders) {
  check<1>(Kernel("linear", 1), 1, cloud<1>(2000), 0, 10);
  check<2>(Kernel("thin-plate", 2), 1, cloud<2>(2000), 0, 25);
  check<2>(Kernel("linear", 2), 1, cloud<2>(2000), 0, 25);
  check<3>(Kernel("linear", 3), 1, cloud<3>(2000), 0, 30);
  check<3>(Kernel("cubic", 3), 1, cloud<3>(2000), 0, 30, 1e-8);
  check<2>(Kernel("matern-c0", 2), .5, cloud<2>(2000), 0, 25);
  check<2>(Kernel("matern-c2", 2), .3, cloud<2>(2000), 0, 40);
  check<2>(Kernel("multiquadric", 2), .02, cloud<2>(2000), 0, 40);
}

TEST(IterativeSystem, SmoothsAsTheDenseSystemDoes) {
  check<2>(Kernel("thin-plate", 2), 1, cloud<2>(3000), 1e-3, 25);
  check<2>(Kernel("thin-plate", 2), 1, cloud<2>(3000), 1, 60);
}

TEST(IterativeSystem, SolvesOnTracksAndInLayers) {
  Points<2> tracks = cloud<2>(3000);
  tracks.row(1) = (5 * tracks.row(1)).array().round();
  check<2>(Kernel("thin-plate", 2), 1, tracks, 0, 30);
  Points<3> layer = cloud<3>(3000);
  layer.row(2) *= 1e-3;
  check<3>(Kernel("linear", 3), 1, layer, 0, 30);
}

TEST(IterativeSystem, SolvesWhereClustersFillUpAtOnce) {
  Points<2> x = cloud<2>(3000);
  x.rightCols(1500) = .3 + 1e-3 * x.rightCols(1500).array();
  check<2>(Kernel("thin-plate", 2), 1, x, 0, 20);
  check<2>(Kernel("linear", 2), 1, x, 0, 20);
}

TEST(IterativeSystem, NeedsAboutAsManyIterationsForMorePoints) {
  const auto iterations = [](Index n) {
    const Points<2> x = cloud<2>(n);
    return solve_iteratively<2>(x, Kernel("thin-plate", 2), 1, Eigen::VectorXd::Zero(1), polynomials<2>(x, 1),
                                wave<2>(x))
        .iterations;
  };
  EXPECT_LT(iterations(20000), 20);
}

TEST(IterativeSystem, EstimatesLeaveOneOutErrors) {
  const Points<2> x = cloud<2>(1000);
  const Kernel kernel("thin-plate", 2);
  const Eigen::MatrixXd G = polynomials<2>(x, 1), s = wave<2>(x);
  const IterativeSolution fast = solve_iteratively<2>(x, kernel, 1, Eigen::VectorXd::Zero(1), G, s, {.neighbors = 60});
  const SaddleSolution exact = solve_saddle(dense<2>(x, kernel, 1), G, s, {});
  const Eigen::ArrayXd ratio =
      fast.alpha.col(0).array() / fast.inverse_diagonal.array() / exact.leave_one_out.col(0).array();
  EXPECT_NEAR(ratio.mean(), 1, .02);
}

TEST(IterativeSystem, SaysWhenTheSystemIsTooIllConditioned) {
  const Points<2> x = cloud<2>(2500);
  try {
    solve_iteratively<2>(x, Kernel("gaussian", 2), 2, Eigen::VectorXd::Zero(1), polynomials<2>(x, 0), wave<2>(x));
    FAIL() << "no exception";
  } catch (const SolverFailure& failure) {
    EXPECT_NE(std::string(failure.what()).find("ill conditioned"), std::string::npos) << failure.what();
  }
}

TEST(IterativeSystem, TakesTheBestResidualThatRoundingAllows) {
  const Points<2> x = cloud<2>(2500);
  const auto solve = [&](double acceptable) {
    return solve_iteratively<2>(x, Kernel("septic", 2), 1, Eigen::VectorXd::Zero(1), polynomials<2>(x, 3), wave<2>(x),
                                {.tolerance = 1e-13, .acceptable = acceptable});
  };
  EXPECT_THROW(solve(0), SolverFailure);
  const IterativeSolution solution = solve(1);
  EXPECT_GT(solution.residual, 1e-13);
  EXPECT_LT(solution.residual, 1);
}

TEST(InverseFactor, WithAllNeighboursIsTheInverse) {
  const Points<2> x = cloud<2>(40);
  const Kernel kernel("thin-plate", 2);
  const Eigen::MatrixXd G = polynomials<2>(x, 1);
  const InverseFactor factor(PointsRef<2>(x), kernel, 1., Eigen::VectorXd::Zero(1), G, 40);
  Eigen::VectorXd alpha = Eigen::VectorXd::Random(40);
  alpha -= G * (G.transpose() * G).ldlt().solve(G.transpose() * alpha);
  const Eigen::VectorXd again = factor.apply(dense<2>(x, kernel, 1) * alpha);
  EXPECT_LT((again - alpha).norm(), 1e-8 * alpha.norm());
}

}  // namespace
}  // namespace csrbf::iterative_system_test
