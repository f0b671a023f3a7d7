#include "thesis/baselines.hpp"

#include "csrbf/core/error.hpp"
#include "thesis/signals.hpp"

#include <gtest/gtest.h>

namespace csrbf::thesis::baselines_test {
namespace {

TEST(BandLimited, MeetsTheValues) {
  const Eigen::VectorXd values = random_points<1>(9, 1).row(0);
  for (Index k = 0; k < 9; ++k)
    EXPECT_NEAR(band_limited(values, -4, 3, static_cast<double>(k - 4) / 6), values[k], 1e-14);
}

// Eq. (1.5): band 20 Hz below W = 25; the values left out decay as 1 / x^4.
TEST(BandLimited, ReconstructsAFunctionOfItsBand) {
  const auto f = [](double x) { return std::pow(sinc(10 * x), 4); };
  Eigen::VectorXd values(401);
  for (Index i = 0; i < 401; ++i) values[i] = f(static_cast<double>(i - 200) / 50);
  for (double x = -1; x <= 1; x += 0.013) EXPECT_NEAR(band_limited(values, -200, 25, x), f(x), 1e-6);
}

TEST(GlobalPolynomial, ReproducesPolynomials) {
  const Points<2> points = random_points<2>(50, 1, -1, 1);
  const auto cubic = [](const Point<2>& p) { return 1 + p[0] - 2 * p[0] * p[1] * p[1] + p[1]; };
  const Points<2> x = random_points<2>(20, 2, -1, 1);
  EXPECT_LT(rms(global_polynomial<2>(points, values_at(points, cubic), 3, x), values_at(x, cubic)), 1e-12);
}

// Mairhuber: points on a circle do not determine a quadratic.
TEST(GlobalPolynomial, RefusesPointsThatAreNotUnisolvent) {
  Points<2> circle(2, 12);
  for (Index i = 0; i < 12; ++i) circle.col(i) << std::cos(static_cast<double>(i)), std::sin(static_cast<double>(i));
  EXPECT_THROW(static_cast<void>(global_polynomial<2>(circle, Eigen::VectorXd::Ones(12), 2, circle)), InvalidInput);
}

TEST(FrameIteration, TheSplinesSumToOneAndHaveTheirKnownValues) {
  EXPECT_NEAR(cubic_b_spline(0), 2.0 / 3, 1e-15);
  EXPECT_NEAR(cubic_b_spline(1), 1.0 / 6, 1e-15);
  for (double x = 0; x < 1; x += 0.1)
    EXPECT_NEAR(cubic_b_spline(x + 1) + cubic_b_spline(x) + cubic_b_spline(x - 1) + cubic_b_spline(x - 2), 1, 1e-14);
}

// Three samples per knot: the error in the norm of the space falls at least by (B - A) / (B + A) per iteration.
TEST(FrameIteration, ConvergesAtTheRateOfTheFrameBounds) {
  constexpr Index count = 12;
  Eigen::VectorXd points(36);
  for (Index i = 0; i < 36; ++i)
    points[i] = (static_cast<double>(i) + 0.3 * std::sin(static_cast<double>(i))) * 11 / 36 + 0.05;
  const Eigen::VectorXd truth = random_points<1>(count, 4).row(0);
  Eigen::VectorXd values = Eigen::VectorXd::Zero(36);
  for (Index i = 0; i < 36; ++i)
    for (Index k = 0; k < count; ++k) values[i] += truth[k] * cubic_b_spline(points[i] - static_cast<double>(k));

  const FrameIteration frame = frame_iteration(points, values, count, 2000);
  ASSERT_GT(frame.A, 0);
  const double rate = (frame.B - frame.A) / (frame.B + frame.A);
  // Norms of coefficients and of functions differ by at most the root of the condition of the Gram matrix, below 20.
  for (Index n = 0; n < 2000; n += 100)
    EXPECT_LE((frame.coefficients.col(n) - truth).norm(),
              20 * std::pow(rate, static_cast<double>(n + 1)) * truth.norm() + 1e-10);
}

TEST(FrameIteration, RefusesAGapThatHidesAFunction) {
  const Eigen::VectorXd points = Eigen::VectorXd::LinSpaced(30, 0, 3);
  EXPECT_THROW(static_cast<void>(frame_iteration(points, points, 12, 10)), SolverFailure);
}

}  // namespace
}  // namespace csrbf::thesis::baselines_test
