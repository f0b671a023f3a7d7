#include "csrbf/approx/fit.hpp"

#include "approx/approx_testing.hpp"

#include "csrbf/approx/function.hpp"

#include <utility>

namespace csrbf {
namespace {

TEST(Fit, TakesValuesOfAnySize) {
  for (const double size : {1e-200, 1e-30, 1e30, 1e200}) {
    Samples<2> data = sample<2>(random_points<2>(1200, 1), franke);
    data.values *= size;
    const Fit<2> result = fit<2>(data);
    EXPECT_LE(result.report.max_error, 1e-3 * size);
    EXPECT_LE(result.report.rmse, result.report.max_error);
    EXPECT_GT(result.report.rmse, 0);
  }
}

TEST(Fit, TakesCoordinatesAndValuesOfAnySize) {
  for (const Index n : {200, 3000}) {
    const Samples<2> data = sample<2>(random_points<2>(n, 1), franke);
    const Points<2> x = random_points<2>(50, 2);
    const double tolerance = n == 200 ? .05 : 1e-3;
    const Eigen::VectorXd truth = sample<2>(x, franke).values.col(0);
    for (const auto& [length, size] :
         {std::pair{1e-300, 1.}, {1e300, 1.}, {1., 1e-300}, {1., 1e300}, {1e-300, 1e300}}) {
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
  for (const Index n : {300, 4000}) {
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

}  // namespace
}  // namespace csrbf
