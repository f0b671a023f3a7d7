#include "csrbf/linalg/simplex_search.hpp"

#include "csrbf/core/error.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace csrbf::simplex_search_test {
namespace {

TEST(SimplexSearch, FindsTheMinimumOfAQuadric) {
  const auto f = [](const Eigen::VectorXd& x) { return std::pow(x[0] - 3, 2) + 10 * std::pow(x[1] + x[0], 2) + 7; };
  const SimplexMinimum found =
      simplex_search(f, Eigen::Vector2d(0, 0), Eigen::Vector2d(1, 1), {.evaluations = 300, .tolerance = 1e-12});
  EXPECT_NEAR(found.value, 7, 1e-10);
  EXPECT_NEAR(found.x[0], 3, 1e-4);
  EXPECT_NEAR(found.x[1], -3, 1e-4);
}

TEST(SimplexSearch, GoesRoundWhatIsNotFinite) {
  const auto f = [](const Eigen::VectorXd& x) {
    return x[0] > 2 ? std::numeric_limits<double>::quiet_NaN() : std::pow(x[0] - 1.9, 2);
  };
  const SimplexMinimum found =
      simplex_search(f, Eigen::VectorXd::Zero(1), Eigen::VectorXd::Ones(1), {.evaluations = 200, .tolerance = 1e-12});
  EXPECT_NEAR(found.x[0], 1.9, 1e-4);
}

TEST(SimplexSearch, KeepsToItsEvaluations) {
  int count = 0;
  const auto f = [&](const Eigen::VectorXd& x) { return ++count, std::cos(x[0]) * x[1]; };
  (void)simplex_search(f, Eigen::Vector2d(0, 0), Eigen::Vector2d(1, 1), {.evaluations = 30, .tolerance = 0});
  EXPECT_LE(count, 30 + 4);
}

TEST(SimplexSearch, NeedsAStepPerVariable) {
  const auto f = [](const Eigen::VectorXd&) { return 0.0; };
  EXPECT_THROW(simplex_search(f, Eigen::Vector2d(0, 0), Eigen::VectorXd::Ones(1)), InvalidInput);
}

}  // namespace
}  // namespace csrbf::simplex_search_test
