#include "csrbf/approx/fit.hpp"

#include "approx/approx_testing.hpp"

#include "csrbf/approx/function.hpp"

#include <utility>
#include <vector>

namespace csrbf::fit_sizes_test {
namespace {

TEST(Fit, TakesValuesOfAnySize) {
  for (const double size : {1e-200, 1e200}) {
    Samples<2> data = sample<2>(random_points<2>(1200, 1), franke);
    data.values *= size;
    const Fit<2> result = fit<2>(data);
    EXPECT_LE(result.report.max_error, 1e-3 * size);
    EXPECT_LE(result.report.rmse, result.report.max_error);
    EXPECT_GT(result.report.rmse, 0);
  }
}

TEST(Fit, TakesCoordinatesAndValuesOfAnySize) {
  using Sizes = std::vector<std::pair<double, double>>;
  const Sizes each = {{1e-300, 1}, {1e300, 1}, {1, 1e-300}, {1, 1e300}, {1e-300, 1e300}};
  const Sizes both = {{1e-300, 1e300}, {1e300, 1e-300}};  // slopes are then larger and smaller still
  for (const Index n : {200, 2600}) {
    const Samples<2> data = sample<2>(random_points<2>(n, 1), franke);
    const Points<2> x = random_points<2>(50, 2);
    const double tolerance = n == 200 ? .05 : 1e-3;
    const Eigen::VectorXd truth = sample<2>(x, franke).values.col(0);
    for (const auto& [length, size] : n == 200 ? each : both) {
      const Function f = fit_function(length * data.points, size * data.values, Eigen::VectorXd(), {});
      const Eigen::VectorXd value = f.evaluate(length * x).value / size;
      EXPECT_LE((value - truth).cwiseAbs().maxCoeff(), tolerance) << n << " " << length << " " << size;
      const Eigen::VectorXd deviation = f.standard_deviation(length * x) / size;
      EXPECT_GT(deviation.minCoeff(), 0) << n << " " << length << " " << size;
      EXPECT_LT(deviation.maxCoeff(), 1) << n << " " << length << " " << size;
      EXPECT_LE(f.report().rmse, 1e-3 * size);
    }
  }
}

TEST(Fit, KnowsLessTheFartherFromItsSamples) {
  for (const Index n : {300, 2600}) {
    const Fit<2> result = fit<2>(sample<2>(random_points<2>(n, 1), franke));
    double before = (*result.variances[0])(Point<2>(.9, .5));
    for (const double x : {1.05, 1.2, 1.4}) {
      const double variance = (*result.variances[0])(Point<2>(x, .5));
      EXPECT_GT(variance, before) << n << " " << x;
      before = variance;
    }
    EXPECT_GE(before, 1e-3);
    EXPECT_LE((*result.variances[0])(Point<2>(3, 3)), 10) << n;
  }
}

// Smooth values and few samples: systems that are singular to rounding.
TEST(Fit, KnowsThatItIsNotExact) {
  const auto friedman = [](const Point<5>& x) {
    const double centered = x[2] - .5;
    return 10 * std::sin(3.14159265358979 * x[0] * x[1]) + 20 * centered * centered + 10 * x[3] + 5 * x[4];
  };
  for (const unsigned seed : {1, 2, 3}) {
    const Fit<5> result = fit<5>(sample<5>(random_points<5>(200, seed), friedman));
    const Points<5> x = (.05 + .9 * random_points<5>(1000, 10 + seed).array()).matrix();
    const Eigen::ArrayXd error =
        result.components[0]->evaluate(x).value.array() - sample<5>(x, friedman).values.col(0).array();
    const Eigen::ArrayXd deviation = result.variances[0]->evaluate(x).value.array().sqrt();
    EXPECT_LE(std::sqrt(error.square().mean()), .005) << seed;
    EXPECT_GT(deviation.minCoeff(), 0) << seed;
    EXPECT_GE(static_cast<double>((error.abs() <= 1.96 * deviation).count()), .75 * 1000) << seed;
  }
}

}  // namespace
}  // namespace csrbf::fit_sizes_test
