#include "csrbf/linalg/quasi_newton_search.hpp"

#include "csrbf/core/error.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace csrbf::quasi_newton_search_test {
namespace {

double rosenbrock(const Eigen::VectorXd& x, Eigen::VectorXd& gradient) {
  const double a = 1 - x[0], b = x[1] - x[0] * x[0];
  gradient[0] = -2 * a - 400 * x[0] * b;
  gradient[1] = 200 * b;
  return a * a + 100 * b * b;
}

TEST(QuasiNewtonSearch, FindsTheEndOfACurvedValley) {
  const QuasiNewtonMinimum found =
      quasi_newton_search(rosenbrock, Eigen::Vector2d(-1.2, 1), Eigen::Vector2d::Constant(-5),
                          Eigen::Vector2d::Constant(5), {.evaluations = 200, .tolerance = 0});
  EXPECT_LE(found.value, 1e-12);
  EXPECT_NEAR(found.x[0], 1, 1e-5);
}

TEST(QuasiNewtonSearch, StopsAtABound) {
  const QuasiNewtonMinimum found =
      quasi_newton_search(rosenbrock, Eigen::Vector2d(-1.2, 1), Eigen::Vector2d::Constant(-5), Eigen::Vector2d(0.5, 5),
                          {.evaluations = 200, .tolerance = 0});
  EXPECT_EQ(found.x[0], 0.5);
  EXPECT_NEAR(found.x[1], 0.25, 1e-5);
}

TEST(QuasiNewtonSearch, GoesRoundWhatIsNotFinite) {
  const auto f = [](const Eigen::VectorXd& x, Eigen::VectorXd& gradient) {
    gradient[0] = 2 * (x[0] - 1.9);
    return x[0] > 2 ? std::numeric_limits<double>::quiet_NaN() : std::pow(x[0] - 1.9, 2);
  };
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(1);
  EXPECT_NEAR(quasi_newton_search(f, 0 * one, -9 * one, 9 * one, {.tolerance = 1e-12}).x[0], 1.9, 1e-4);
}

TEST(QuasiNewtonSearch, KeepsToItsEvaluations) {
  int count = 0;
  const auto f = [&](const Eigen::VectorXd& x, Eigen::VectorXd& g) { return ++count, rosenbrock(x, g); };
  (void)quasi_newton_search(f, Eigen::Vector2d(-1.2, 1), Eigen::Vector2d::Constant(-5), Eigen::Vector2d::Constant(5),
                            {.evaluations = 12, .tolerance = 0});
  EXPECT_LE(count, 12);
}

TEST(QuasiNewtonSearch, NeedsBoundsForEveryVariable) {
  EXPECT_THROW(quasi_newton_search(rosenbrock, Eigen::Vector2d(0, 0), Eigen::VectorXd::Zero(1), Eigen::Vector2d(1, 1)),
               InvalidInput);
}

}  // namespace
}  // namespace csrbf::quasi_newton_search_test
