#include "csrbf/approx/outside/extrapolate.hpp"

#include "approx/approx_testing.hpp"
#include "csrbf/approx/function.hpp"

namespace csrbf::extrapolate_test {
namespace {

Samples<1> wave() {
  Samples<1> samples{Points<1>(1, 60), Eigen::MatrixXd(60, 1), {}};
  for (Index i = 0; i < 60; ++i) {
    samples.points(0, i) = static_cast<double>(i) / 59;
    samples.values(i, 0) = std::sin(6 * samples.points(0, i));
  }
  return samples;
}

// What the samples say is that the function goes on: a constant is as wrong as that differs.
TEST(Extrapolate, DeviationsAreThoseOfWhatIsReturned) {
  const Eigen::MatrixXd x = Eigen::RowVector2d(1.05, .5);
  for (const Extrapolation cut : {Extrapolation::constant, Extrapolation::linear}) {
    const Function given(fit(wave(), {.extrapolation = cut}));
    const Function changed = Function(fit(wave(), {.extrapolation = Extrapolation::trend})).extrapolated(cut);
    for (const Function* function : {&given, &changed}) {
      const double error = std::abs(function->evaluate(x).value(0, 0) - std::sin(6.3));
      const Eigen::MatrixXd deviation = function->standard_deviation(x);
      EXPECT_NEAR(deviation(0, 0), error, .05 * error);
      EXPECT_LE(deviation(1, 0), 1e-5);
    }
  }
}

TEST(Extrapolate, CanBeChangedAgain) {
  const Function trend(fit(wave(), {.extrapolation = Extrapolation::trend}));
  const Function again = trend.extrapolated(Extrapolation::constant).extrapolated(Extrapolation::trend);
  const Eigen::MatrixXd x = Eigen::RowVector4d(-.2, .5, 1.05, 1.3);
  EXPECT_LE((again.evaluate(x).value - trend.evaluate(x).value).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LE((again.standard_deviation(x) - trend.standard_deviation(x)).cwiseAbs().maxCoeff(), 1e-9);
}

// Of a positive bump that ends at the border logarithms are fitted, whose deviations are large outside.
TEST(Extrapolate, DeviationsOfLogarithmsAreBoundedByTheRangeOfTheValues) {
  const Samples<2> samples = sample<2>(
      random_points<2>(80, 1), [](const Point<2>& p) { return std::exp(-30 * (p - Point<2>(.5, .95)).squaredNorm()); });
  const Fit<2> found = fit(samples);
  ASSERT_EQ(found.report.transforms.at(0), "log");
  const Eigen::MatrixXd x{{1.3, 3, .5}, {.5, -2, 9}};
  const Eigen::MatrixXd deviation = Function(found).standard_deviation(x);
  EXPECT_GT(deviation.minCoeff(), .01);
  EXPECT_LE(deviation(0, 0), 1.4);
  EXPECT_LE(deviation.maxCoeff(), 11);
}

// Of few samples several functions are likely, and all count.
TEST(Extrapolate, ChangesNothingInside) {
  for (const Index n : {3, 4}) {
    const Function few(fit(sample<1>(random_points<1>(n, 3), [](const Point<1>& t) { return std::sin(5 * t[0]); })));
    const Eigen::MatrixXd bounds = few.bounds();
    const Eigen::MatrixXd x = Eigen::RowVectorXd::LinSpaced(20, bounds(0, 0), bounds(0, 1));
    const Eigen::MatrixXd before = few.standard_deviation(x);
    for (const Extrapolation other : {Extrapolation::constant, Extrapolation::linear})
      EXPECT_LE((few.extrapolated(other).standard_deviation(x) - before).cwiseAbs().maxCoeff(),
                1e-6 * before.maxCoeff());
  }
}

// Inside the range of three or four samples, of which no covariance can be chosen.
TEST(Fit, DeviationsOfFewSamplesAreThoseOfLikelyFunctions) {
  using Curve = double (*)(double);
  for (const Index n : {2, 3, 4}) {
    Index within = 0, all = 0;
    for (unsigned seed = 0; seed < 24; ++seed) {
      const std::array<Curve, 4> curves = {
          [](double t) { return std::sin(5 * t); }, [](double t) { return std::exp(2 * t); },
          [](double t) { return 1 / (1 + 10 * (t - .4) * (t - .4)); }, [](double t) { return std::cos(9 * t) + t; }};
      const Curve f = curves[seed % 4];
      Samples<1> samples = sample<1>(random_points<1>(n, 100 * seed + static_cast<unsigned>(n)),
                                     [&](const Point<1>& t) { return f(t[0]); });
      const Fit<1> result = fit(samples);
      const double lo = samples.points.minCoeff(), hi = samples.points.maxCoeff();
      const Points<1> x = Eigen::RowVectorXd::LinSpaced(50, lo, hi);
      const Eigen::ArrayXd deviation = result.variances[0]->evaluate(x).value.array().sqrt();
      const Eigen::VectorXd value = result.components[0]->evaluate(x).value;
      for (Index i = 0; i < x.cols(); ++i, ++all)
        within += std::abs(value[i] - f(x(0, i))) <= 1.96 * deviation[i] + 1e-9 ? 1 : 0;
    }
    EXPECT_GE(static_cast<double>(within), .88 * static_cast<double>(all)) << n;
  }
}

}  // namespace
}  // namespace csrbf::extrapolate_test
