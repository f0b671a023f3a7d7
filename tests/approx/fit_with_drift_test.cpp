#include "csrbf/approx/fit_with_drift.hpp"

#include "approx/approx_testing.hpp"
#include "csrbf/approx/fit.hpp"

namespace csrbf::fit_with_drift_test {
namespace {

constexpr double slope = -2.5;

// x, y and a covariate that varies from sample to sample; values waves(x, y) + slope z.
Samples<3> with_covariate(Index n, unsigned seed) {
  return sample<3>(random_points<3>(n, seed),
                   [](const Point<3>& p) { return waves<2>(Point<2>(p[0], p[1])) + slope * p[2]; });
}

TEST(FitWithDrift, FindsTheCoefficientOfACovariate) {
  for (const Index n : {200, 3000}) {
    const Samples<3> data = with_covariate(n, 1);
    const Fit<3> result = fit<3>(data, {.drift = {2}});
    ASSERT_EQ(result.report.drift.size(), 1U);
    EXPECT_NEAR(result.report.drift[0], slope, 1e-4);
    EXPECT_EQ(result.report.drift_axes, std::vector<int>{2});
    const Samples<3> other = with_covariate(500, 2);
    Samples<3> inner = other;
    inner.points.topRows(2).array() = .1 + .8 * inner.points.topRows(2).array();
    inner = sample<3>(inner.points, [](const Point<3>& p) { return waves<2>(Point<2>(p[0], p[1])) + slope * p[2]; });
    EXPECT_LE(largest_error<3>(*result.components[0], inner), 1e-4);
  }
}

TEST(FitWithDrift, IsLinearInTheCovariateAndHasExactDerivatives) {
  const Fit<3> result = fit<3>(with_covariate(200, 1), {.drift = {2}});
  const Points<3> x = (.2 + .6 * random_points<3>(20, 4).array()).matrix();
  expect_true_derivatives<3>(*result.components[0], x, 1e-4, 1e-4);
  const Jet<3> jet = result.components[0]->evaluate(x, Derivatives::hessian);
  for (Index i = 0; i < x.cols(); ++i) {
    EXPECT_EQ(jet.gradient(2, i), result.report.drift[0]);
    EXPECT_TRUE(jet.hessian_matrix(i).col(2).isZero());
  }
}

TEST(FitWithDrift, MeasuresCoefficientsUnderNoiseAsWellAsItSays) {
  Samples<3> data = with_covariate(400, 1);
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal(0, .1);
  for (double& value : data.values.reshaped()) value += normal(random);
  const Fit<3> result = fit<3>(data, {.drift = {2}});
  EXPECT_NEAR(result.report.drift_deviations[0], .1 / std::sqrt(400 / 12.), .006);
  EXPECT_LE(std::abs(result.report.drift[0] - slope), 3 * result.report.drift_deviations[0]);
  ASSERT_EQ(result.variances.size(), 1U);
  const Point<3> inside(.5, .5, .5), far(.5, .5, 50);
  EXPECT_NEAR(std::sqrt((*result.variances[0])(inside)), .1, .02);
  EXPECT_NEAR(std::sqrt((*result.variances[0])(far)), 49.5 * result.report.drift_deviations[0], .2);
}

// A trend in time and a season of it: the second coordinate is the same time, many periods long.
TEST(FitWithDrift, FollowsASeasonOverManyPeriods) {
  constexpr double trend = .01, period = 365.25, turn = 6.28318530717958648;
  Points<2> times(2, 400);
  times.row(0) = 3000 * random_points<1>(400, 1);
  times.row(1) = times.row(0);
  const auto truth = [&](const Point<2>& t) { return trend * t[0] + 5 * std::sin(turn * t[1] / period); };
  Samples<2> data = sample<2>(times, truth);
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal(0, .1);
  for (double& value : data.values.reshaped()) value += normal(random);
  const Fit<2> result = fit<2>(data, {.periods = {0, period}, .drift = {0}});
  EXPECT_NEAR(result.report.drift[0], trend, 2e-5);
  for (const double t : {3100.0, 3300.0})
    EXPECT_NEAR((*result.components[0])(Point<2>(t, t)), truth(Point<2>(t, t)), .1) << t;
}

// Whether an arc lies at the beginning of its circle or an eighth of a turn on: there both of its coordinates vary.
TEST(FitWithDrift, TakesAnArcAsItLies) {
  Samples<3> data = sample<3>(random_points<3>(250, 1), [](const Point<3>& p) { return fractal(p.head<2>()); });
  data.points.row(0) = 4 * data.points.row(0).array() - 2;
  data.points.row(1) *= 4;
  const FitReport one = fit<3>(data, {.periods = {360, 0, 0}, .drift = {2}}).report;
  data.points.row(0).array() += 45;
  const FitReport turned = fit<3>(data, {.periods = {360, 0, 0}, .drift = {2}}).report;
  EXPECT_NEAR(turned.drift[0], one.drift[0], 0.1 * one.drift_deviations[0]);
  EXPECT_NEAR(turned.drift_deviations[0], one.drift_deviations[0], 0.05 * one.drift_deviations[0]);
}

TEST(FitWithDrift, KeepsItsUnits) {
  Samples<3> data = with_covariate(200, 1);
  const Fit<3> usual = fit<3>(data, {.drift = {2}});
  constexpr double elsewhere = 5e-5;  // by rounding, the search for lengths and noise ends a little beside
  const double there = (*usual.components[0])(data.points.col(0));
  data.values *= 1e250;
  data.points.topRows(2) *= 1e-200;
  const Fit<3> result = fit<3>(data, {.drift = {2}});
  EXPECT_NEAR(result.report.drift[0] / 1e250, usual.report.drift[0], 1e-6);
  EXPECT_NEAR((*result.components[0])(data.points.col(0)) / 1e250, there, elsewhere);
}

TEST(FitWithDrift, NamesWhatIsWrong) {
  Samples<3> data = with_covariate(100, 1);
  expect_refusal([&] { fit<3>(data, {.drift = {3}}); }, "drift");
  expect_refusal([&] { fit<3>(data, {.drift = {0, 1, 2}}); }, "must leave one axis");
  data.points.row(2).setConstant(7);
  expect_refusal([&] { fit<3>(data, {.drift = {2}}); }, "the same everywhere");
  data.points.row(2) = 2 * data.points.row(1);
  data.points.row(0) = random_points<1>(100, 8);
  data.points.row(1) = random_points<1>(100, 9);
  data.points.row(2) = 3 * data.points.row(1);
  expect_refusal([&] { fit<3>(data, {.drift = {1, 2}}); }, "linear function of the others");
}

}  // namespace
}  // namespace csrbf::fit_with_drift_test
