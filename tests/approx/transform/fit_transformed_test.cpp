#include "approx/approx_testing.hpp"
#include "csrbf/approx/fit.hpp"
#include "csrbf/approx/function.hpp"
#include "csrbf/core/error.hpp"

#include <gtest/gtest.h>

#include <random>

namespace csrbf::fit_transformed_test {
namespace {

// Between 1 and some 30, as concentrations are.
double amount(const Point<2>& x) {
  return std::exp(1.7 + 1.2 * std::sin(5 * x[0]) * std::cos(4 * x[1]));
}

// Their errors are factors.
Samples<2> amounts(Index n, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Samples<2> samples{random_points<2>(n, seed), Eigen::MatrixXd(n, 1), {}};
  for (Index i = 0; i < n; ++i) {
    samples.values(i, 0) = amount(samples.points.col(i)) * std::exp(.4 * normal(random));
  }
  return samples;
}

// Over the truth, the mean of samples there.
double relative_error(const Fit<2>& fit, double mean_of_noise) {
  const Points<2> x = random_points<2>(1000, 99);
  const Eigen::VectorXd found = fit.components[0]->evaluate(x).value;
  double sum = 0;
  for (Index i = 0; i < x.cols(); ++i) sum += std::pow(found[i] / (mean_of_noise * amount(x.col(i))) - 1, 2);
  return std::sqrt(sum / 1000);
}

// Noise that grows with the values is even on the scale of logarithms: low values are as exact as high ones, and
// intervals hold at both.
TEST(FitTransformed, FindsAmountsWhoseErrorsAreFactors) {
  const Samples<2> samples = amounts(320, 3);
  FitOptions plain;
  plain.transform = "none";
  const Fit<2> as_they_are = fit(samples, plain), found = fit(samples);
  ASSERT_EQ(found.report.transforms, std::vector<std::string>{"log"});
  EXPECT_TRUE(as_they_are.report.transforms.empty());
  const double mean_of_noise = std::exp(.08);
  EXPECT_LT(relative_error(found, mean_of_noise), .9 * relative_error(as_they_are, mean_of_noise));
  const Samples<2> others = amounts(1500, 4);
  const Function function(found);
  const Eigen::VectorXd deviation = function.standard_deviation(others.points),
                        values = function.evaluate(others.points).value;
  for (const bool is_low : {true, false}) {
    Index inside = 0, count = 0;
    for (Index i = 0; i < others.size(); ++i) {
      if ((values[i] < 4) != is_low) continue;
      ++count;
      inside += std::abs(others.values(i, 0) - values[i]) <= 1.96 * deviation[i] ? 1 : 0;
    }
    ASSERT_GT(count, 250);
    EXPECT_NEAR(static_cast<double>(inside) / static_cast<double>(count), .95, .025) << is_low;
  }
  // Without the noise, the deviation of the function grows with the values, too.
  const Eigen::VectorXd of_function = function.standard_deviation(others.points, DeviationOf::function);
  EXPECT_TRUE((of_function.array() < deviation.array()).all());
  EXPECT_GT(of_function.minCoeff(), 0);
  EXPECT_NEAR(found.report.noise[0] / as_they_are.report.noise[0], 1, .25);
}

TEST(FitTransformed, LeavesOtherValuesAsTheyAre) {
  std::mt19937_64 random(8);
  std::normal_distribution<double> normal;
  Samples<2> samples{random_points<2>(150, 8), Eigen::MatrixXd(150, 1), {}};
  for (Index i = 0; i < 150; ++i) {
    const Point<2> x = samples.points.col(i);
    samples.values(i, 0) = 6 + 4 * std::sin(5 * x[0]) * std::cos(4 * x[1]) + .4 * normal(random);
  }
  ASSERT_GT(samples.values.minCoeff(), 0);
  EXPECT_TRUE(fit(samples).report.transforms.empty());
  samples = amounts(150, 5);
  samples.values.array() += 100;  // all of a size
  EXPECT_TRUE(fit(samples).report.transforms.empty());
  samples = amounts(150, 5);
  samples.values(7, 0) = -.1;
  EXPECT_TRUE(fit(samples).report.transforms.empty());
  samples = amounts(150, 5);
  samples.weights = Eigen::VectorXd::LinSpaced(150, 1, 2);
  EXPECT_TRUE(fit(samples).report.transforms.empty());
}

// Values of any unit, and marks of missing ones.
TEST(FitTransformed, SeesMissingValuesAndUnits) {
  Samples<2> samples = amounts(320, 3);
  const Fit<2> all = fit(samples);
  samples.values *= 1e200;
  const Fit<2> large = fit(samples);
  EXPECT_EQ(large.report.transforms, all.report.transforms);
  const Point<2> x(.4, .6);
  EXPECT_NEAR((*large.components[0])(x), 1e200 * (*all.components[0])(x), 1e192);
  samples = amounts(320, 3);
  for (Index i = 0; i < 320; i += 20) samples.values(i, 0) = -9999;
  FitOptions options;
  options.missing = -9999;
  const Fit<2> some = fit(samples, options);
  EXPECT_EQ(some.report.missing, 16);
  EXPECT_EQ(some.report.transforms, all.report.transforms);
  EXPECT_GT(some.components[0]->evaluate(samples.points).value.minCoeff(), 0);
}

// An exponential of what a trend may do far away.
TEST(FitTransformed, StaysFiniteFarFromTheSamples) {
  Samples<1> samples{Points<1>(1, 200), Eigen::MatrixXd(200, 1), {}};
  for (Index i = 0; i < 200; ++i) {
    const double t = static_cast<double>(i) / 20;
    samples.points(0, i) = t;
    samples.values(i, 0) = std::exp(.2 * t + std::sin(2 * t) + .3 * std::sin(1e4 * t));
  }
  FitOptions options;
  options.transform = "log";
  const Function function(fit(samples, options));
  const double largest = samples.values.maxCoeff();
  const Eigen::RowVectorXd far{{-3, 11, 12, 15, 50, 1000}};
  for (const DeviationOf of : {DeviationOf::sample, DeviationOf::function})
    EXPECT_LT(function.standard_deviation(far, of).maxCoeff(), 5 * largest);
  const Function outside = function.extrapolated(Extrapolation::nan);
  for (const DeviationOf of : {DeviationOf::sample, DeviationOf::function})
    EXPECT_TRUE(outside.standard_deviation(far, of).array().isNaN().all());
}

// log(1) is 0.
TEST(FitTransformed, LeavesOutMissingValuesOnly) {
  Samples<2> samples = amounts(100, 5);
  for (Index i = 0; i < 30; ++i) samples.values(i, 0) = i < 10 ? 0 : 1;
  FitOptions options;
  options.transform = "log";
  options.missing = 0;
  EXPECT_EQ(fit(samples, options).report.missing, 10);
}

// Each column as it needs, where all need one.
TEST(FitTransformed, ChoosesForEachValue) {
  Samples<2> samples = amounts(320, 3);
  samples.values.conservativeResize(320, 2);
  samples.values.col(1) = amounts(320, 3).values * 3;
  EXPECT_EQ(fit(samples).report.transforms, (std::vector<std::string>{"log", "log"}));
  for (Index i = 0; i < 320; ++i) samples.values(i, 1) = waves<2>(samples.points.col(i));
  EXPECT_TRUE(fit(samples).report.transforms.empty());
}

void expect_refused(const Samples<2>& samples, const FitOptions& options, const std::string& text) {
  try {
    (void)fit(samples, options);
    FAIL() << text;
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
  }
}

TEST(FitTransformed, RefusesWhatCannotBe) {
  Samples<2> samples = amounts(100, 5);
  FitOptions options;
  options.transform = "ln";
  expect_refused(samples, options, "transform = ln: unknown; use one of auto, none, sqrt, log");
  options.transform = "log";
  options.tolerance = .1;
  expect_refused(samples, options, "transform = log: does not go with a tolerance");
  options.tolerance = 0;
  samples.values(12, 0) = 0;
  expect_refused(samples, options, "transform = log: sample 12 (from 0) has the value 0");
  options.transform = "sqrt";
  EXPECT_EQ(fit(samples, options).report.transforms, std::vector<std::string>{"sqrt"});
  samples.values(12, 0) = -1;
  expect_refused(samples, options, "sample 12 (from 0) has the value -1");
}

}  // namespace
}  // namespace csrbf::fit_transformed_test
