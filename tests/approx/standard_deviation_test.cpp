#include "approx/approx_testing.hpp"
#include "csrbf/approx/fit.hpp"
#include "csrbf/approx/fit_method.hpp"
#include "csrbf/approx/function.hpp"

#include <numbers>

namespace csrbf::standard_deviation_test {
namespace {

constexpr double noise = .05;

Samples<2> noisy(const Points<2>& points, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> error(0, noise);
  return sample<2>(points, [&](const Point<2>& p) { return franke(p) + error(random); });
}

// Of other samples, those within 1.96 deviations.
double share_within(const Fit<2>& fit, const Samples<2>& others) {
  const Function function(fit);
  const Eigen::ArrayXd error = function.evaluate(others.points).value.col(0) - others.values.col(0);
  return (error.abs() < 1.96 * function.standard_deviation(others.points).col(0).array()).cast<double>().mean();
}

// A part of the square has no samples.
TEST(StandardDeviation, IsKnownByEveryMethodOnRequest) {
  Points<2> points = random_points<2>(500, 1);
  for (auto p : points.colwise())
    if ((p - Point<2>(.3, .3)).norm() < .15) p = p.array() + .3;
  const Samples<2> samples = noisy(points, 2), others = noisy(random_points<2>(1000, 3), 4);
  for (const FitMethodInfo& method : fit_method_table()) {
    SCOPED_TRACE(method.name);
    FitOptions options{.method = method.name, .standard_deviation = true};
    if (method.method == FitMethod::fixed_budget) options.centers = 60;
    if (method.method == FitMethod::error_bounded) options.tolerance = 4 * noise;
    const double share = share_within(fit(samples, options), others);
    EXPECT_GT(share, .9);
    EXPECT_LT(share, .99);
  }
}

TEST(StandardDeviation, OfAFunctionHasNoNoiseOnRequest) {
  const Samples<2> samples = noisy(random_points<2>(600, 5), 6);
  const Function function(fit(samples, {.method = "multilevel", .standard_deviation = true}));
  const Points<2> x = random_points<2>(50, 7);
  const Eigen::ArrayXd all = function.standard_deviation(x).col(0),
                       own = function.standard_deviation(x, DeviationOf::function).col(0);
  EXPECT_TRUE(((all.square() - own.square()).sqrt() - noise).abs().maxCoeff() < .01);
}

// Error-bounded fits of noise follow it; what is left of a wide budget is far more than noise.
TEST(StandardDeviation, CountsWhatAFunctionMisses) {
  const Samples<2> samples = sample<2>(random_points<2>(500, 8), peaks),
                   others = sample<2>(random_points<2>(500, 9), peaks);
  const Fit<2> rough = fit(samples, {.method = "fixed-budget", .centers = 15, .standard_deviation = true});
  const Eigen::ArrayXd error = (rough.components[0]->evaluate(others.points).value - others.values.col(0)).cwiseAbs();
  const Eigen::ArrayXd deviation = Function(rough).standard_deviation(others.points).col(0);
  EXPECT_GT(error.maxCoeff(), .3);
  EXPECT_LT((error - deviation).abs().maxCoeff(), .05);  // auto is nearly exact
}

TEST(StandardDeviation, IsKnownOnTheSphereWithCovariatesAndInManyDimensions) {
  Points<2> places(2, 500);
  for (Index i = 0; i < places.cols(); ++i) {
    const Point<2> p = random_points<2>(1, static_cast<unsigned>(i)).col(0);
    places.col(i) << 360 * p[0] - 180, std::asin(2 * p[1] - 1) * 180 / std::numbers::pi;
  }
  const auto height = [](const Point<2>& p) {
    return std::sin(p[0] * std::numbers::pi / 180) * std::cos(p[1] * std::numbers::pi / 180);
  };
  const Fit<2> round =
      fit(sample<2>(places, height), {.method = "multilevel", .sphere = {0, 1}, .standard_deviation = true});
  EXPECT_TRUE((round.variances.at(0)->evaluate(places).value.array() >= 0).all());
  EXPECT_LT(round.variances.at(0)->evaluate(places).value.maxCoeff(), 1e-3);

  const Points<2> points = random_points<2>(300, 10);
  const auto line = [](const Point<2>& p) { return std::sin(5 * p[0]) + 3 * p[1]; };
  const Fit<2> drift = fit(sample<2>(points, line), {.method = "multilevel", .drift = {1}, .standard_deviation = true});
  EXPECT_TRUE((drift.variances.at(0)->evaluate(points).value.array() >= 0).all());

  const Fit<5> many =
      fit(sample<5>(random_points<5>(300, 11), waves<5>), {.method = "multilevel", .standard_deviation = true});
  EXPECT_TRUE((many.variances.at(0)->evaluate(random_points<5>(50, 12)).value.array() > 0).all());
}

// Axes in other units: the same function and samples.
TEST(StandardDeviation, IsInTheUnitsOfTheSamples) {
  const Samples<2> samples = noisy(random_points<2>(300, 14), 15);
  const Points<2> x = random_points<2>(100, 16);
  const Point<2> unit(1000, .001);
  Samples<2> scaled = samples;
  scaled.points.array().colwise() *= unit.array();
  for (const char* method : {"multilevel", "moving-least-squares"}) {
    const FitOptions options{.method = method, .standard_deviation = true};
    const Eigen::VectorXd same = fit(samples, options).variances.at(0)->evaluate(x).value;
    const Points<2> there = (x.array().colwise() * unit.array()).matrix();
    const Eigen::VectorXd found = fit(scaled, options).variances.at(0)->evaluate(there).value;
    EXPECT_LT((found - same).cwiseAbs().mean(), .3 * same.mean()) << method;
  }
}

TEST(StandardDeviation, OfTooFewSamplesIsUnknown) {
  const Samples<2> one = sample<2>(random_points<2>(1, 13), franke);
  const Fit<2> result = fit(one, {.method = "multilevel", .standard_deviation = true});
  ASSERT_TRUE(result.variances.empty());
  EXPECT_NE(result.report.warnings.back().find("too few samples"), std::string::npos);
  expect_refusal([&] { (void)Function(fit(one, {.method = "multilevel"})).standard_deviation(one.points); },
                 "samples at a single place tell none");
  const Samples<2> more = sample<2>(random_points<2>(100, 13), franke);
  expect_refusal([&] { (void)Function(fit(more, {.method = "multilevel"})).standard_deviation(more.points); },
                 "give standard_deviation to fit");
}

}  // namespace
}  // namespace csrbf::standard_deviation_test
