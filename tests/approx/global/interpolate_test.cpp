#include "csrbf/approx/global/interpolate.hpp"

#include "approx/interpolate_testing.hpp"
#include "core/error_testing.hpp"
#include "csrbf/approx/basis/expansion.hpp"
#include "csrbf/approx/global/choose_kernel.hpp"
#include "csrbf/approx/global/kriging_variance.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace csrbf::interpolate_test {
namespace {

template <int Dim>
double largest_residual(const Interpolation<Dim>& fit, const Samples<Dim>& samples) {
  double largest = 0;
  for (Index k = 0; k < samples.components(); ++k) {
    const Eigen::VectorXd values = fit.components[k]->evaluate(samples.points).value;
    largest = std::max(largest, (values - samples.values.col(k)).cwiseAbs().maxCoeff());
  }
  return largest;
}

TEST(Interpolate, OfOneLinearKernelOnTheLineIsPiecewiseLinear) {
  Samples<1> samples{Points<1>::Zero(1, 3), Eigen::Vector3d(1, 3, -1), {}};
  samples.points << 0, 1, 4;
  const Interpolation<1> fit = interpolate(samples, {.kernel = "linear"});
  for (const double x : {0., .25, 1., 2.5, 4.}) {
    const double expected = x < 1 ? 1 + 2 * x : 3 - 4 * (x - 1) / 3;
    EXPECT_NEAR((*fit.components[0])(Point<1>(x)), expected, 1e-14) << x;
  }
}

template <int Dim>
void check_every_kernel() {
  const Samples<Dim> samples = sample<Dim>(wave<Dim>, 60);
  for (const std::string& name : Kernel::names(Dim)) {
    InterpolateOptions options{.kernel = name};
    const Kernel kernel(name, Dim);
    // Analytic kernels of wide support are singular to working precision.
    if (kernel.has_scale()) options.support = kernel.compact() ? 2 : (kernel.smoothness() == 100 ? .2 : 1);
    const Interpolation<Dim> fit = interpolate(samples, options);
    // Rounding times coefficients, which grow with the condition.
    EXPECT_LT(largest_residual(fit, samples), fit.report.condition < 1e8 ? 1e-9 : 1e-6)
        << name << " in dimension " << Dim;
    EXPECT_EQ(fit.report.kernel, name);
    EXPECT_EQ(fit.report.degree, default_degree(kernel));
    EXPECT_TRUE(std::isfinite(fit.report.leave_one_out)) << name;
  }
}

TEST(Interpolate, WithEveryKernelPassesThroughTheData) {
  check_every_kernel<1>();
  check_every_kernel<2>();
  check_every_kernel<3>();
}

TEST(Interpolate, WorksInSixDimensions) {
  const Samples<6> samples = sample<6>(wave<6>, 200);
  EXPECT_LT(largest_residual(interpolate(samples, {.kernel = "cubic"}), samples), 1e-10);
}

TEST(Interpolate, LeaveOneOutErrorIsThatOfLeavingOneOut) {
  const Samples<2> samples = sample<2>(wave<2>, 25);
  for (const char* name : {"thin-plate", "wendland-c2"}) {
    const InterpolateOptions options{.kernel = name, .support = 1.5};
    double squares = 0;
    for (Index k = 0; k < 25; ++k) {
      std::vector<Index> rest;
      for (Index i = 0; i < 25; ++i)
        if (i != k) rest.push_back(i);
      const Samples<2> fewer{samples.points(Eigen::all, rest), samples.values(rest, Eigen::all), {}};
      const double value = (*interpolate(fewer, options).components[0])(samples.points.col(k));
      squares += std::pow(value - samples.values(k, 0), 2) / 25;
    }
    EXPECT_NEAR(interpolate(samples, options).report.leave_one_out / std::sqrt(squares), 1, 1e-9) << name;
  }
}

TEST(Interpolate, ReproducesPolynomialsOfItsDegree) {
  const auto quadratic = [](const Point<3>& p) { return 1 + p[0] - 2 * p[1] * p[2] + p[0] * p[0]; };
  const Samples<3> samples = sample<3>(quadratic, 50);
  for (const char* name : {"quintic", "gaussian"}) {
    const Interpolation<3> fit = interpolate(samples, {.kernel = name, .support = .3, .degree = 2});
    EXPECT_LT(rmse<3>(*fit.components[0], quadratic, 2 * random_points<3>(100, 5)), 1e-10) << name;
  }
}

TEST(Interpolate, SolvesAllComponentsLikeEachAlone) {
  Samples<2> samples = sample<2>(wave<2>, 40);
  samples.values.conservativeResize(40, 2);
  samples.values.col(1) = samples.points.row(0).transpose().array().square();
  const InterpolateOptions options{.kernel = "cubic"};
  const Interpolation<2> both = interpolate(samples, options);
  const Points<2> x = random_points<2>(50, 8);
  for (Index k = 0; k < 2; ++k) {
    const Interpolation<2> one = interpolate<2>({samples.points, samples.values.col(k), {}}, options);
    EXPECT_TRUE(one.components[0]->evaluate(x).value.isApprox(both.components[k]->evaluate(x).value, 1e-12));
  }
}

TEST(Interpolate, DoesNotDependOnUnits) {
  const Samples<2> samples = sample<2>(wave<2>, 50);
  const Points<2> x = random_points<2>(50, 8);
  for (const char* name : {"thin-plate", "wendland-c4"}) {
    const InterpolateOptions options{.kernel = name, .smoothing = 1e-3};
    const Eigen::VectorXd expected = interpolate(samples, options).components[0]->evaluate(x).value;
    for (const double unit : {1e-30, 1e30}) {
      Samples<2> scaled = samples;
      scaled.points *= unit;
      scaled.values *= unit;
      scaled.weights = Eigen::VectorXd::Constant(50, unit);
      const Eigen::VectorXd values = interpolate(scaled, options).components[0]->evaluate(unit * x).value;
      EXPECT_LT((values / unit - expected).cwiseAbs().maxCoeff(), 1e-6) << name;  // of the chosen support
    }
  }
}

TEST(Interpolate, ReplacesDuplicatesByTheirWeightedMean) {
  Samples<2> samples = sample<2>(wave<2>, 30);
  Samples<2> twice = samples;
  twice.points.conservativeResize(2, 31);
  twice.values.conservativeResize(31, 1);
  twice.points.col(30) = twice.points.col(4);
  twice.values(30, 0) = 7;
  twice.weights = Eigen::VectorXd::Ones(31);
  twice.weights[30] = 3;
  const Interpolation<2> fit = interpolate(twice, {.kernel = "cubic"});
  EXPECT_EQ(fit.report.merged, 1);
  EXPECT_NEAR((*fit.components[0])(samples.points.col(4)), (samples.values(4, 0) + 3 * 7) / 4, 1e-12);
}

TEST(Interpolate, LeavesOutSamplesOfWeightZero) {
  Samples<2> samples = sample<2>(wave<2>, 30);
  samples.weights = Eigen::VectorXd::Ones(30);
  samples.weights[3] = 0;
  samples.values(3, 0) = 1e6;
  EXPECT_EQ(interpolate(samples, {.kernel = "cubic"}).components[0]->basis().size(), 29);
}

TEST(Interpolate, OfConstantDataIsConstant) {
  const Samples<2> samples = sample<2>([](const Point<2>&) { return 4.25; }, 40);
  for (const char* name : {"auto", "gaussian", "cubic", "wendland-c2"}) {
    const Interpolation<2> fit = interpolate(samples, {.kernel = name});
    EXPECT_NEAR((*fit.components[0])(Point<2>(3, -2)), 4.25, 1e-10) << name;
  }
}

TEST(Interpolate, HandlesCollinearPoints) {
  Samples<2> samples = sample<2>(wave<2>, 20);
  samples.points.row(1) = 2 * samples.points.row(0);
  for (const char* name : {"auto", "thin-plate", "quintic", "wendland-c2"}) {
    const Interpolation<2> fit = interpolate(samples, {.kernel = name});
    EXPECT_LT(largest_residual(fit, samples), 1e-6) << name;
    EXPECT_TRUE(std::isfinite((*fit.components[0])(Point<2>(.3, -.4))));
  }
}

TEST(Interpolate, HandlesFewPoints) {
  for (Index n = 1; n <= 6; ++n) {
    const Samples<3> samples = sample<3>(wave<3>, n);
    for (const char* name : {"auto", "thin-plate", "quintic", "gaussian"}) {
      const Interpolation<3> fit = interpolate(samples, {.kernel = name});
      EXPECT_LT(largest_residual(fit, samples), 1e-6) << name << " " << n;
    }
  }
}

TEST(Interpolate, SmoothsNoiseByAChosenLambda) {
  Samples<2> samples = sample<2>(wave<2>, 400);
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal(0, .2);
  for (double& value : samples.values.reshaped()) value += normal(random);
  const Points<2> x = random_points<2>(500, 9);
  for (const auto criterion : {LambdaCriterion::leave_one_out, LambdaCriterion::generalized_cross_validation}) {
    const Interpolation<2> fit =
        interpolate(samples, {.kernel = "thin-plate", .smoothing = std::nullopt, .criterion = criterion});
    const double error = rmse<2>(*fit.components[0], wave<2>, x);
    double best = 1;
    for (double lambda = 1e-6; lambda < 1e4; lambda *= 3) {
      const Interpolation<2> other = interpolate(samples, {.kernel = "thin-plate", .smoothing = lambda});
      best = std::min(best, rmse<2>(*other.components[0], wave<2>, x));
    }
    EXPECT_LT(error, 1.25 * best);
    EXPECT_LT(error, .2 / 2);  // half the noise
    EXPECT_GT(fit.report.smoothing, 0);
  }
}

// The conditions that determine it: A alpha + lambda alpha + G pi = s and G^T alpha = 0.
TEST(Interpolate, SolvesItsSystemSparseOrDense) {
  constexpr double lambda = 1e-4;
  for (const Index n : {400, 2000}) {
    const Samples<2> samples = sample<2>(franke, n);
    const Interpolation<2> fit =
        interpolate(samples, {.kernel = "wendland-c2", .support = .12, .smoothing = lambda, .degree = 1});
    EXPECT_EQ(fit.report.solver, n > 1500 ? InterpolationSolver::sparse_direct : InterpolationSolver::dense);
    const Expansion<2>& f = *fit.components[0];
    const Eigen::VectorXd& alpha = f.coefficients();
    const Eigen::VectorXd residual = samples.values.col(0) - f.evaluate(samples.points).value - lambda * alpha;
    EXPECT_LT(residual.cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_LT((samples.points * alpha).norm() + std::abs(alpha.sum()), 1e-9 * alpha.cwiseAbs().sum());
  }
}

TEST(Interpolate, OnPeriodicAxesIsPeriodic) {
  const auto f = [](const Point<2>& p) { return std::cos(2 * std::numbers::pi * p[0]) + p[1]; };
  const Samples<2> samples = sample<2>(f, 200);
  RadialMetric<2> metric;
  metric.periods = Point<2>(1, 0);
  const Interpolation<2> fit = interpolate(samples, {.kernel = "wendland-c4", .support = .6}, metric);
  for (const double y : {.1, .5, .8}) {
    EXPECT_NEAR((*fit.components[0])(Point<2>(.01, y)), (*fit.components[0])(Point<2>(1.01, y)), 1e-9);
    EXPECT_NEAR((*fit.components[0])(Point<2>(.001, y)), f(Point<2>(.001, y)), 1e-2);
  }
}

// |T (p - c)| is the distance of T p and T c, and polynomials of x are those of T x.
TEST(Interpolate, WithAMetricIsThatOfTransformedPoints) {
  const Samples<2> samples = sample<2>(wave<2>, 120);
  RadialMetric<2> metric;
  metric.transforms = {(Eigen::Matrix2d() << 1.5, .4, -.2, .6).finished()};
  Samples<2> mapped = samples;
  mapped.points = metric.transforms[0] * samples.points;
  const Points<2> x = .5 * (Points<2>::Random(2, 50).array() + 1);
  for (const char* kernel : {"wendland-c4", "thin-plate"}) {
    const InterpolateOptions options{.kernel = kernel, .support = .8, .degree = 1};
    const auto with_metric = interpolate(samples, options, metric);
    const auto transformed = interpolate(mapped, options);
    const Points<2> there = metric.transforms[0] * x;
    EXPECT_LE((with_metric.components[0]->evaluate(x).value - transformed.components[0]->evaluate(there).value)
                  .cwiseAbs()
                  .maxCoeff(),
              1e-8)
        << kernel;
    EXPECT_LE((with_metric.variances[0]->evaluate(x).value - transformed.variances[0]->evaluate(there).value)
                  .cwiseAbs()
                  .maxCoeff(),
              1e-8 * transformed.variances[0]->sigma2())
        << kernel;
  }
}

TEST(Interpolate, RejectsBadInput) {
  const Samples<2> samples = sample<2>(wave<2>, 20);
  const auto message = [&](const InterpolateOptions& options) {
    return invalid_input_message([&] { (void)interpolate(samples, options); });
  };
  EXPECT_EQ(message({.kernel = "thin-plate", .degree = 0}),
            "interpolate: degree = 0: thin-plate needs at least degree 1");
  EXPECT_EQ(message({.smoothing = -1}),
            "interpolate: smoothing = -1: must be finite and not negative; leave it empty to have it chosen");
  EXPECT_EQ(message({.support = -2}), "interpolate: support = -2: must be positive and finite, or 0 to have it chosen");
  EXPECT_EQ(message({.tolerance = 1}),
            "interpolate: tolerance = 1: must be positive and below 1, or 0 for the default");
  EXPECT_EQ(
      invalid_input_message([] { (void)interpolate(sample<4>(wave<4>, 20), {.kernel = "cubic", .dense_limit = 10}); }),
      "interpolate: number of samples = 20: is above dense_limit; use a compactly supported kernel, such as "
      "wendland-c2, or a partition of unity");
  EXPECT_EQ(message({.kernel = "splines"}).find("kernel = splines: unknown; use one of wendland-c0"), 0U);
  EXPECT_EQ(invalid_input_message([] { (void)interpolate(Samples<2>{}); }),
            "interpolate: samples = none: at least one sample is needed");
  Samples<2> line = samples;
  line.points.row(1).setZero();
  EXPECT_NE(invalid_input_message([&] {
              (void)interpolate(line, {.kernel = "cubic", .degree = 1});
            }).find("lower the degree"),
            std::string::npos);
  RadialMetric<2> metric;
  metric.periods = Point<2>(1, 0);
  EXPECT_EQ(invalid_input_message([&] { (void)interpolate(samples, {.kernel = "cubic"}, metric); }),
            "interpolate: kernel = cubic: periodic axes need a compactly supported kernel");
}

}  // namespace
}  // namespace csrbf::interpolate_test
