#include "csrbf/approx/left_out/left_out_blocks.hpp"

#include "approx/approx_testing.hpp"
#include "csrbf/approx/function.hpp"

namespace csrbf::left_out_blocks_test {
namespace {

double wave(const Point<2>& x) {
  return std::sin(5 * x[0]) * std::cos(4 * x[1]);
}

// Points of the unit square on one side of its diagonal.
Points<2> triangle(Index count, unsigned seed, bool below) {
  Points<2> x = random_points<2>(count, seed);
  for (Index i = 0; i < count; ++i)
    if ((x.col(i).sum() < 1) != below) x.col(i) = Point<2>(1 - x(1, i), 1 - x(0, i));
  return x;
}

InterpolateOptions smooth(double smoothing) {
  return {.kernel = "gaussian", .support = .3, .smoothing = smoothing, .degree = 0};
}

// A wave is no random function with the covariance that predicts it best between the samples.
TEST(LeftOutBlocks, SmoothFunctionsAreFurtherOffBeyondTheSamples) {
  const Samples<2> samples = sample<2>(triangle(200, 1, true), wave);
  const InterpolateOptions options = smooth(1e-12);
  const double sigma2 = interpolate(samples, options).variances.front()->sigma2();
  const ErrorGrowth growth = left_out_blocks<2>(samples, options, Eigen::VectorXd::Constant(1, sigma2)).front();
  EXPECT_GT(growth.factor, 2);
  EXPECT_GT(growth.distance, 1);
  // Deviations that are wide enough as they are do not grow.
  EXPECT_EQ(left_out_blocks<2>(samples, options, Eigen::VectorXd::Constant(1, 1e6 * sigma2)).front().factor, 1);
}

TEST(LeftOutBlocks, TwoDozenSamplesTell) {
  const auto line = [](const Point<1>& x) { return 2 * x[0] + .1 * std::sin(6 * x[0]); };
  const Function function(fit(sample<1>(random_points<1>(25, 2), line)));
  const Eigen::MatrixXd ends = function.bounds();
  for (const double x : {ends(0, 0) - .15, ends(0, 1) + .15}) {
    const Eigen::MatrixXd there = Eigen::MatrixXd::Constant(1, 1, x);
    const double error = std::abs(function.evaluate(there).value(0, 0) - line(Point<1>(x)));
    EXPECT_GT(function.standard_deviation(there)(0, 0), .5 * error);
  }
}

TEST(LeftOutBlocks, NoiseOrFewSamplesDoNotTell) {
  const auto grown = [](Samples<2> samples, double noise) {
    const Points<2> scatter = random_points<2>(samples.size(), 9);
    samples.values.col(0) += noise * (scatter.row(0).array() - .5).matrix().transpose();
    const double sigma2 = interpolate(samples, smooth(.1)).variances.front()->sigma2();
    return left_out_blocks<2>(samples, smooth(.1), Eigen::VectorXd::Constant(1, sigma2)).front().factor;
  };
  EXPECT_EQ(grown(sample<2>(random_points<2>(200, 1), [](const Point<2>&) { return 0.0; }), 1), 1);
  EXPECT_EQ(grown(sample<2>(triangle(12, 1, true), wave), 0), 1);
}

// Samples of no weight, a constant beside the values, and a degree that a part of the samples does not determine.
TEST(LeftOutBlocks, WhatDoesNotTellDoesNotMatter) {
  Samples<2> samples = sample<2>(triangle(200, 1, true), wave);
  const InterpolateOptions options = smooth(1e-12);
  const double sigma2 = interpolate(samples, options).variances.front()->sigma2();
  const double factor = left_out_blocks<2>(samples, options, Eigen::VectorXd::Constant(1, sigma2)).front().factor;
  Samples<2> more{Points<2>(2, 300), Eigen::MatrixXd::Constant(300, 2, 4), Eigen::VectorXd::Zero(300)};
  more.points << samples.points, random_points<2>(100, 5);
  more.values.col(0).head(200) = samples.values.col(0);
  more.weights.head(200).setOnes();
  const std::vector<ErrorGrowth> both = left_out_blocks<2>(more, options, Eigen::Vector2d(sigma2, 0));
  EXPECT_NEAR(both.front().factor, factor, 1e-3 * factor);
  EXPECT_EQ(both.back().factor, 1);
  InterpolateOptions high = options;
  high.degree = 8;
  EXPECT_GE(left_out_blocks<2>(sample<2>(triangle(60, 1, true), wave), high, Eigen::VectorXd::Ones(1)).front().factor,
            1);
}

TEST(LeftOutBlocks, IntervalsHoldInTheOtherHalfOfTheSquare) {
  const Fit<2> fit = csrbf::fit<2>(sample<2>(triangle(300, 1, true), wave));
  ASSERT_EQ(fit.report.method, "interpolate");
  Points<2> x = triangle(500, 2, false);
  const Eigen::VectorXd f = fit.components[0]->evaluate(x).value, v = fit.variances[0]->evaluate(x).value;
  Index within = 0;
  for (Index i = 0; i < x.cols(); ++i) within += std::abs(f[i] - wave(x.col(i))) <= 1.96 * std::sqrt(v[i]) ? 1 : 0;
  EXPECT_GE(within, 350);
}

// Rational functions are rougher than the gaussian kernel that predicts them best between the samples.
TEST(LeftOutBlocks, IntervalsHoldInGapsOfALine) {
  constexpr double golden = 0.6180339887498949;
  Points<1> points(1, 200);
  for (Index i = 0, k = 1; i < points.cols(); ++k)
    if (const double x = std::fmod(golden * static_cast<double>(k), 1); std::abs(x - .5) > .12) points(0, i++) = x;
  const Points<1> gap = Points<1>(Eigen::RowVectorXd::LinSpaced(50, .385, .615));
  for (const double middle : {.3, .4, .7}) {
    const auto f = [&](const Point<1>& x) { return 1 / (1 + 12 * std::pow(x[0] - middle, 2)); };
    const Fit<1> fit = csrbf::fit<1>(sample<1>(points, f));
    const Eigen::ArrayXd off = fit.components[0]->evaluate(gap).value - sample<1>(gap, f).values;
    EXPECT_GE((off.square() < 3.84 * fit.variances[0]->evaluate(gap).value.array()).count(), 20)
        << middle;  // of 50; 15 at most by the likelihood alone
  }
}

// Two samples of a rough function are a hundredth apart, all others a tenth: a third one on one of them is as far off
// as these may be from each other.
TEST(LeftOutBlocks, RoughFunctionsAreUnknownWithinTheLeastDistance) {
  Points<2> points = unit_grid(11);
  points(0, 60) += .09;
  const Samples<2> samples = sample<2>(points, wave);
  InterpolateOptions options{.kernel = "matern-c0", .support = .5, .smoothing = 0, .degree = 0};
  const Eigen::VectorXd sigma2 = Eigen::VectorXd::Constant(1, 2);
  const ErrorGrowth rough = left_out_blocks<2>(samples, options, sigma2).front();
  EXPECT_NEAR(rough.least, 1 - Kernel("matern-c0", 2).value(.01 / .5), 1e-12);
  const auto variance = interpolate(samples, options).variances.front()->with(2, rough);
  EXPECT_NEAR(variance->evaluate(points.col(60)).value[0], 2 * rough.least, 1e-12);
  EXPECT_GT(variance->evaluate(Point<2>(.05, .05)).value[0], 4 * rough.least);
  options.kernel = "matern-c2";
  EXPECT_LE(left_out_blocks<2>(samples, options, sigma2).front().least, 1e-15);
}

}  // namespace
}  // namespace csrbf::left_out_blocks_test
