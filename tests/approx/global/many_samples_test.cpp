#include "csrbf/approx/basis/expansion.hpp"
#include "csrbf/approx/global/interpolate.hpp"
#include "csrbf/approx/global/kriging_variance.hpp"
#include "csrbf/core/error.hpp"

#include <gtest/gtest.h>
#include <Eigen/LU>

#include <random>

namespace csrbf::many_samples_test {
namespace {

template <int Dim>
Samples<Dim> wave(Index n) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Samples<Dim> samples{Points<Dim>::NullaryExpr(Dim, n, [&] { return uniform(random); }), Eigen::MatrixXd(n, 1), {}};
  samples.values.col(0) =
      ((5 * samples.points.row(0).array()).sin() * (4 * samples.points.row(Dim - 1).array()).cos()).transpose();
  return samples;
}

TEST(InterpolateManySamples, GivesWhatTheDenseSystemGives) {
  const Samples<2> samples = wave<2>(1200);
  const Points<2> x = .9 * wave<2>(300).points;
  for (const char* kernel : {"linear", "thin-plate", "cubic", "matern-c2"}) {
    InterpolateOptions options{.kernel = kernel, .support = .5};
    const Interpolation<2> dense = interpolate(samples, options);
    options.dense_limit = 100;
    const Interpolation<2> fast = interpolate(samples, options);
    ASSERT_EQ(fast.report.solver, InterpolationSolver::fast_sums);
    EXPECT_GT(fast.report.iterations, 0);
    EXPECT_LE(fast.report.residual, 1e-8);
    EXPECT_NEAR(fast.report.leave_one_out / dense.report.leave_one_out, 1, .1) << kernel;
    const Eigen::VectorXd difference = fast.components[0]->evaluate(x).value - dense.components[0]->evaluate(x).value;
    EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-6) << kernel;
    const Eigen::ArrayXd ratio =
        fast.variances[0]->evaluate(x).value.array() / dense.variances[0]->evaluate(x).value.array();
    EXPECT_NEAR(ratio.mean(), 1, .1) << kernel;
  }
}

TEST(InterpolateManySamples, IsEvaluatedByFastSumsWithDerivatives) {
  const Samples<2> samples = wave<2>(12000);
  const Interpolation<2> fit = interpolate(samples, {.kernel = "thin-plate"});
  EXPECT_LE(fit.report.residual, 1e-8);
  const Expansion<2>& f = *fit.components[0];
  ASSERT_NE(f.basis().fast_sum(), nullptr);
  EXPECT_LT((f.evaluate(samples.points).value - samples.values.col(0)).cwiseAbs().maxCoeff(), 1e-6);
  const Points<2> x = .9 * wave<2>(200).points;
  const Jet<2> jet = f.evaluate(x, Derivatives::hessian);
  const Eigen::ArrayXXd t = x.array();
  const Eigen::ArrayXd fx = 5 * (5 * t.row(0)).cos() * (4 * t.row(1)).cos();
  const Eigen::ArrayXd fxx = -25 * (5 * t.row(0)).sin() * (4 * t.row(1)).cos();
  EXPECT_LT((jet.gradient.row(0).transpose().array() - fx).abs().maxCoeff(), .01);
  EXPECT_LT((jet.hessian.row(0).transpose().array() - fxx).abs().maxCoeff(), 2);
}

TEST(InterpolateManySamples, ChoosesAKernelAndSmoothing) {
  Samples<2> samples = wave<2>(6000);
  std::mt19937 random(2);
  std::normal_distribution<double> normal(0, .1);
  for (double& value : samples.values.reshaped()) value += normal(random);
  const Interpolation<2> fit = interpolate(samples, {.smoothing = std::nullopt});
  EXPECT_EQ(fit.report.solver, InterpolationSolver::fast_sums);
  EXPECT_GT(fit.report.smoothing, 0);
  const Samples<2> truth = wave<2>(6000);
  const Eigen::VectorXd error = fit.components[0]->evaluate(truth.points).value - truth.values.col(0);
  EXPECT_LT(std::sqrt(error.squaredNorm() / 6000), .03);
  EXPECT_NEAR(fit.report.leave_one_out, .1, .02);
}

// Between samples, the error against the truth is near that of the best smoothing.
template <int Dim>
void expect_best_smoothing(const char* kernel, double noise) {
  Samples<Dim> samples = wave<Dim>(2000);
  const Samples<Dim> between = wave<Dim>(4000);
  const Points<Dim> at = between.points.rightCols(2000);
  const Eigen::VectorXd truth = between.values.bottomRows(2000);
  std::mt19937 random(2);
  std::normal_distribution<double> normal(0, noise);
  for (double& value : samples.values.reshaped()) value += normal(random);
  InterpolateOptions options{.kernel = kernel, .smoothing = std::nullopt, .dense_limit = 1000};
  const auto error = [&](const Interpolation<Dim>& fit) {
    return (fit.components[0]->evaluate(at).value - truth).norm();
  };
  const Interpolation<Dim> fit = interpolate(samples, options);
  EXPECT_EQ(fit.report.solver, InterpolationSolver::fast_sums);
  for (const double factor : {.2, 5.}) {
    options.smoothing = factor * fit.report.smoothing;
    EXPECT_LT(error(fit), 1.04 * error(interpolate(samples, options))) << kernel << ' ' << noise << ' ' << factor;
  }
}

TEST(InterpolateManySamples, ChoosesAboutTheBestSmoothing) {
  expect_best_smoothing<2>("thin-plate", .1);
  expect_best_smoothing<3>("linear", .1);
}

TEST(InterpolateManySamples, DoesNotSmoothWithoutNoise) {
  const Samples<2> samples = wave<2>(2000);
  const InterpolateOptions options{.kernel = "thin-plate", .smoothing = std::nullopt, .dense_limit = 1000};
  const Interpolation<2> fit = interpolate(samples, options);
  const Eigen::VectorXd error = fit.components[0]->evaluate(samples.points).value - samples.values.col(0);
  EXPECT_LT(error.norm(), .1 * std::sqrt(2000.) * fit.report.leave_one_out);
}

TEST(InterpolateManySamples, WithAMetricIsTheSameInMappedCoordinates) {
  Samples<2> samples = wave<2>(9000);
  const Eigen::Matrix2d T{{2, .5}, {0, 30}};
  Samples<2> squeezed = samples;
  squeezed.points = T.inverse() * samples.points;
  const Interpolation<2> plain = interpolate(samples, {.kernel = "thin-plate"});
  const Interpolation<2> mapped = interpolate(squeezed, {.kernel = "thin-plate"}, {.transforms = {T}});
  const Points<2> x = .9 * wave<2>(100).points;
  const Jet<2> a = plain.components[0]->evaluate(x, Derivatives::gradient);
  const Jet<2> b = mapped.components[0]->evaluate(Points<2>(T.inverse() * x), Derivatives::gradient);
  EXPECT_LT((a.value - b.value).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_LT((T.transpose() * a.gradient - b.gradient).cwiseAbs().maxCoeff(), 1e-3);
}

TEST(InterpolateManySamples, InSpace) {
  const Samples<3> samples = wave<3>(5000);
  const Interpolation<3> fit = interpolate(samples, {.kernel = "linear"});
  EXPECT_EQ(fit.report.solver, InterpolationSolver::fast_sums);
  EXPECT_LE(fit.report.residual, 1e-7);
  EXPECT_LE(fit.report.iterations, 40);
}

TEST(InterpolateManySamples, TakesFewCentresForABound) {
  const Samples<2> samples = wave<2>(5000);
  Index before = samples.size();
  for (const double bound : {1e-3, 1e-2}) {
    const Interpolation<2> fit = interpolate(samples, {.kernel = "thin-plate", .largest_error = bound});
    const Expansion<2>& f = *fit.components[0];
    EXPECT_LE((f.evaluate(samples.points).value - samples.values.col(0)).cwiseAbs().maxCoeff(), bound);
    EXPECT_LT(f.basis().size(), before / 2) << bound;
    before = f.basis().size();
  }
}

// Whatever the input: residuals that are measured, or one sentence.
template <int Dim>
void expect_answer_or_sentence(const Samples<Dim>& samples, const char* kernel) {
  try {
    const Interpolation<Dim> fit = interpolate(samples, {.kernel = kernel, .dense_limit = 100});
    const Eigen::VectorXd error = fit.components[0]->evaluate(samples.points).value - samples.values.col(0);
    EXPECT_LT(error.cwiseAbs().maxCoeff(), 1e-6 * samples.values.cwiseAbs().maxCoeff()) << kernel;
  } catch (const SolverFailure& failure) {
    EXPECT_NE(std::string(failure.what()).find("ill conditioned"), std::string::npos) << failure.what();
  }
}

TEST(InterpolateManySamples, AnswersOrSaysWhyNotForBadInput) {
  for (const char* kernel : {"linear", "thin-plate", "cubic"}) {
    Samples<2> twins = wave<2>(2000);
    twins.points.rightCols(1000) = twins.points.leftCols(1000).array() + 1e-12;
    twins.values.bottomRows(1000) = twins.values.topRows(1000);
    expect_answer_or_sentence(twins, kernel);
    twins.values.bottomRows(1000).array() += 1;  // a jump over 1e-12
    expect_answer_or_sentence(twins, kernel);
    Samples<2> line = wave<2>(1500);
    line.points.row(1) = 3 * line.points.row(0);
    expect_answer_or_sentence(line, kernel);
    Samples<2> tiny = wave<2>(1500);
    tiny.points *= 1e-12;
    expect_answer_or_sentence(tiny, kernel);
    Samples<2> same = wave<2>(1500);
    same.points.leftCols(1400).setConstant(.5);
    same.values.topRows(1400).setConstant(.5);
    expect_answer_or_sentence(same, kernel);
  }
}

TEST(InterpolateManySamples, InClustersOfVeryDifferentSize) {
  Samples<2> samples = wave<2>(5000);
  for (Index i = 0; i < 5000; ++i)
    samples.points.col(i) = .5 * samples.points.col(i - i % 500) +
                            std::pow(10., -1 - .3 * static_cast<double>(i / 500)) * samples.points.col(i);
  samples.values.col(0) = (5 * samples.points.row(0).array()).sin().transpose();
  for (const char* kernel : {"linear", "thin-plate"}) {
    const Interpolation<2> fit = interpolate(samples, {.kernel = kernel});
    EXPECT_LE(fit.report.iterations, 30) << kernel;
  }
}

}  // namespace
}  // namespace csrbf::many_samples_test
