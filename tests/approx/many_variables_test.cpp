#include "csrbf/approx/function.hpp"

#include "approx/approx_testing.hpp"
#include "csrbf/io/models/function_archive.hpp"
#include "io/models/function_testing.hpp"

// Functions of more variables than the templates have, by fit_function().
namespace csrbf::many_variables_test {
namespace {

Eigen::MatrixXd points_in(Index variables, Index count, unsigned seed = 1) {
  return random_points<1>(variables * count, seed).reshaped(variables, count);
}

// Of the first three variables, and a little of the last.
double smooth(const Eigen::VectorXd& x) {
  return std::sin(3 * x[0] + x[1]) + x[2] * x[2] + 0.3 * x[x.size() - 1];
}

Eigen::VectorXd slopes(const Eigen::VectorXd& x) {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(x.size());
  const double wave = std::cos(3 * x[0] + x[1]);
  result.head(3) << 3 * wave, wave, 2 * x[2];
  result[x.size() - 1] += 0.3;
  return result;
}

Eigen::VectorXd smooth_at(const Eigen::MatrixXd& points) {
  Eigen::VectorXd values(points.cols());
  for (Index i = 0; i < points.cols(); ++i) values[i] = smooth(points.col(i));
  return values;
}

double rms(const Eigen::MatrixXd& errors) {
  return errors.norm() / std::sqrt(static_cast<double>(errors.size()));
}

Eigen::VectorXd noise(Index count, double deviation) {
  if (deviation == 0) return Eigen::VectorXd::Zero(count);
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal(0, deviation);
  return Eigen::VectorXd::NullaryExpr(count, [&] { return normal(random); });
}

TEST(ManyVariables, AreFitted) {
  for (const Index d : {7, 8, 13, 20}) {
    const Eigen::MatrixXd points = points_in(d, 300), x = points_in(d, 200, 2);
    const Function f = fit_function(points, smooth_at(points), Eigen::VectorXd());
    EXPECT_EQ(f.dimension(), d);
    EXPECT_EQ(f.report().method, "interpolate");
    ASSERT_EQ(std::ssize(f.report().axis_scales), d);
    EXPECT_GT(f.report().axis_scales[4], 10 * f.report().axis_scales[0]) << d;  // does not matter
    const Function::Values values = f.evaluate(x, Derivatives::hessian);
    EXPECT_LE(rms(values.value - smooth_at(x)), 5e-3) << d;
    ASSERT_EQ(values.gradient.cols(), d);
    ASSERT_EQ(values.hessian.cols(), d * (d + 1) / 2);
    double worst = 0;
    for (Index i = 0; i < x.cols(); ++i)
      worst = std::max(worst, (values.gradient.row(i).transpose() - slopes(x.col(i))).norm());
    EXPECT_LE(worst, 0.5) << d;
    EXPECT_EQ(f.bounds().col(0), points.rowwise().minCoeff());
    EXPECT_EQ(f.bounds().rows(), d);
  }
}

TEST(ManyVariables, HaveHessiansOfTheirOwn) {
  const Index d = 8;
  const Eigen::MatrixXd points = points_in(d, 400), x = points_in(d, 5, 2);
  const Function f = fit_function(points, smooth_at(points), Eigen::VectorXd());
  const Function::Values values = f.evaluate(x, Derivatives::hessian);
  constexpr double step = 1e-4;
  for (Index a = 0, entry = 0; a < d; ++a)
    for (Index b = a; b < d; ++b, ++entry) {
      Eigen::MatrixXd more = x, less = x;
      more.row(b).array() += step;
      less.row(b).array() -= step;
      const Eigen::VectorXd difference = (f.evaluate(more, Derivatives::gradient).gradient.col(a) -
                                          f.evaluate(less, Derivatives::gradient).gradient.col(a)) /
                                         (2 * step);
      EXPECT_LE((values.hessian.col(entry) - difference).cwiseAbs().maxCoeff(), 1e-3) << a << ' ' << b;
    }
}

TEST(ManyVariables, AreFittedToNoisySamplesWithHonestDeviations) {
  const Index d = 9;
  const Eigen::MatrixXd points = points_in(d, 600), x = points_in(d, 500, 2);
  const Function f = fit_function(points, smooth_at(points) + noise(600, 0.1), Eigen::VectorXd());
  const Eigen::VectorXd errors = f.evaluate(x).value - smooth_at(x);
  EXPECT_LE(rms(errors), 0.05);
  EXPECT_NEAR(f.report().noise[0], 0.1, 0.01);
  const Eigen::VectorXd deviation = f.standard_deviation(x, DeviationOf::function);
  const double inside = (errors.array().abs() < 1.96 * deviation.array()).cast<double>().mean();
  EXPECT_GE(inside, 0.85);
  EXPECT_LE(rms(deviation), 2 * rms(errors));
}

// More samples than one system can have as centres.
TEST(ManyVariables, UseAllOfManySamples) {
  const Index d = 8, n = 6000;
  const Eigen::MatrixXd points = points_in(d, n), x = points_in(d, 500, 2);
  const Function f = fit_function(points, smooth_at(points) + noise(n, 0.1), Eigen::VectorXd());
  EXPECT_EQ(f.report().samples_fitted, n);
  EXPECT_LT(f.report().centers, n / 2);
  EXPECT_LE(rms(f.evaluate(x).value - smooth_at(x)), 0.012);
  EXPECT_NEAR(f.report().noise[0], 0.1, 0.005);
}

// Of what centres do not see, their covariance may say far more than there is.
TEST(ManyVariables, OfManySamplesHaveHonestDeviations) {
  const Index d = 7, n = 5000;
  const Eigen::MatrixXd points = points_in(d, n), x = points_in(d, 500, 2);
  const auto bump = [](const Eigen::MatrixXd& at) -> Eigen::VectorXd {
    return (-4 * (at.topRows(4).array() - 0.4).square().colwise().sum()).exp().transpose();
  };
  const Function f = fit_function(points, bump(points) + noise(n, 0.01), Eigen::VectorXd());
  const Eigen::VectorXd deviations = f.standard_deviation(x);
  EXPECT_LE(rms(f.evaluate(x).value - bump(x)), 0.006);
  EXPECT_GE(deviations.minCoeff(), 0.009);
  EXPECT_LE(deviations.mean(), 0.015);
}

TEST(ManyVariables, MayBeFittedWithAConstantValue) {
  const Index n = 4500;
  const Eigen::MatrixXd points = points_in(8, n), x = points_in(8, 100, 2);
  Eigen::MatrixXd values(n, 2);
  values << smooth_at(points) + noise(n, 0.1), Eigen::VectorXd::Constant(n, 3);
  const Function f = fit_function(points, values, Eigen::VectorXd());
  const Eigen::MatrixXd found = f.evaluate(x).value;
  EXPECT_LE(rms(found.col(0) - smooth_at(x)), 0.02);
  EXPECT_LE((found.col(1).array() - 3).abs().maxCoeff(), 1e-9);
  EXPECT_TRUE(f.standard_deviation(x).allFinite());
  expect_same(function_from(written(f)).function, f, x);
}

TEST(ManyVariables, OfMoreThan4000SamplesTakeADegreeButNoKernel) {
  const Eigen::MatrixXd points = points_in(7, 4100);
  const Eigen::VectorXd values = smooth_at(points) + noise(4100, 0.1);
  EXPECT_EQ(fit_function(points, values, Eigen::VectorXd(), {.degree = 1}).report().degree, 1);
  expect_refusal([&] { fit_function(points, values, Eigen::VectorXd(), {.kernel = "gaussian"}); },
                 "fit: samples = 4100: more than 4000 of more than six variables");
}

// A constant column says nothing.
TEST(ManyVariables, AreThoseOfFewWithConstants) {
  const Eigen::MatrixXd few = points_in(3, 150), at = points_in(3, 100, 2);
  const Eigen::VectorXd values = smooth_at(few);
  const auto more = [](const Eigen::MatrixXd& x) {
    Eigen::MatrixXd result = Eigen::MatrixXd::Constant(7, x.cols(), 0.25);
    result.topRows(3) = x;
    return result;
  };
  const Function expected = fit_function(few, values, Eigen::VectorXd());
  const Function found = fit_function(more(few), values, Eigen::VectorXd());
  EXPECT_LE(rms(found.evaluate(more(at)).value - expected.evaluate(at).value), 1e-3);
}

TEST(ManyVariables, OfTwoPlacesAndCovariates) {
  const Index d = 9, n = 400;
  const Eigen::MatrixXd points = points_in(d, n), x = points_in(d, 100, 2);
  const Eigen::VectorXd beta = Eigen::VectorXd::LinSpaced(d - 2, -1, 2);
  const auto f = [&](const Eigen::MatrixXd& p) -> Eigen::VectorXd {
    return (3 * p.row(0).array()).sin().matrix().transpose() + p.bottomRows(d - 2).transpose() * beta;
  };
  FitOptions options;
  for (int a = 2; a < d; ++a) options.drift.push_back(a);
  const Function fitted = fit_function(points, f(points) + noise(n, 0.01), Eigen::VectorXd(), options);
  ASSERT_EQ(std::ssize(fitted.report().drift), d - 2);
  for (Index k = 0; k < d - 2; ++k) EXPECT_NEAR(fitted.report().drift[static_cast<std::size_t>(k)], beta[k], 0.02);
  EXPECT_LE(rms(fitted.evaluate(x).value - f(x)), 0.02);
  const Function::Values values = fitted.evaluate(x, Derivatives::gradient);
  EXPECT_LE((values.gradient.col(5).array() - beta[3]).abs().maxCoeff(), 0.02);
  EXPECT_LE(rms(fitted.standard_deviation(x)), 0.03);
  const NamedFunction read = function_from(to_archive(NamedFunction{fitted}));
  expect_same(read.function, fitted, x);
}

// More samples than the covariates' own fields take one system of, and more than six places.
TEST(ManyVariables, OfManyPlacesAndACovariate) {
  const Index d = 9, n = 600;
  const Eigen::MatrixXd points = points_in(d, n), x = points_in(d, 50, 2);
  const auto f = [&](const Eigen::MatrixXd& p) -> Eigen::VectorXd {
    return (3 * p.row(0).array()).sin().matrix().transpose() + 2 * p.row(d - 1).transpose();
  };
  FitOptions options;
  options.drift = {static_cast<int>(d - 1)};
  const Function fitted = fit_function(points, f(points) + noise(n, 0.01), Eigen::VectorXd(), options);
  EXPECT_NEAR(fitted.report().drift[0], 2, 0.02);
  EXPECT_LE(rms(fitted.evaluate(x).value - f(x)), 0.02);
  expect_same(function_from(to_archive(NamedFunction{fitted})).function, fitted, x);
}

// Turned axes of two places, of which the report is of nine variables.
TEST(ManyVariables, MayHaveTurnedAxesBesideCovariates) {
  const Index d = 9, n = 400;
  const Eigen::MatrixXd points = points_in(d, n), x = points_in(d, 20, 2);
  FitOptions options;
  for (int a = 2; a < d; ++a) options.drift.push_back(a);
  const Eigen::VectorXd values =
      (25 * (points.row(0) + points.row(1)).array()).sin().matrix().transpose() + points.row(4).transpose();
  const Function fitted = fit_function(points, values, Eigen::VectorXd(), options);
  ASSERT_EQ(fitted.report().axes.size(), 2U);
  EXPECT_EQ(std::ssize(fitted.report().axes[0]), d);
  expect_same(function_from(to_archive(NamedFunction{fitted})).function, fitted, x);
}

TEST(ManyVariables, AreKeptByModels) {
  const Eigen::MatrixXd points = points_in(11, 200), x = points_in(11, 20, 2);
  for (const double deviation : {0.0, 0.1}) {
    const Function f = fit_function(points, smooth_at(points) + noise(200, deviation), Eigen::VectorXd());
    const NamedFunction read = function_from(to_archive(NamedFunction{f}));
    EXPECT_EQ(read.function.dimension(), 11);
    EXPECT_EQ(read.coordinate_names.back(), "x11");
    expect_same(read.function, f, x);
  }
}

TEST(ManyVariables, MayBePeriodic) {
  const Index d = 7;
  Eigen::MatrixXd points = points_in(d, 400);
  const auto f = [](const Eigen::MatrixXd& p) -> Eigen::VectorXd {
    return (2 * 3.14159265358979323846 * p.row(0).array()).sin() + p.row(1).array();
  };
  FitOptions options;
  options.periods = {1, 0, 0, 0, 0, 0, 0};
  const Function fitted = fit_function(points, f(points), Eigen::VectorXd(), options);
  Eigen::MatrixXd x = points_in(d, 100, 2), shifted = x;
  shifted.row(0).array() += 1;
  EXPECT_LE(rms(fitted.evaluate(x).value - fitted.evaluate(shifted).value), 1e-9);
  EXPECT_LE(rms(fitted.evaluate(x).value - f(x)), 0.02);
  options.periods = {1, 0};
  expect_refusal([&] { fit_function(points, f(points), Eigen::VectorXd(), options); },
                 "fit: periods = 2: one per axis");
}

TEST(ManyVariables, AreRefusedWhatNeedsPatches) {
  const Eigen::MatrixXd points = points_in(8, 100);
  const Eigen::VectorXd values = smooth_at(points);
  const auto expect = [&](const FitOptions& options, const std::string& text) {
    expect_refusal([&] { fit_function(points, values, Eigen::VectorXd(), options); }, text);
  };
  expect({.method = "partition-of-unity"}, "fit: method = partition-of-unity: is for fewer variables");
  expect({.centers = 20}, "fit: centers = 20: is for fewer variables");
  FitOptions slopes;
  slopes.gradients = Eigen::MatrixXd::Zero(100, 8);
  expect(slopes, "fit: gradients = given: are for fewer variables");
  expect({.sphere = {0, 1}}, "fit: dimension = 8: with a sphere there are at most 5 coordinates");
  expect({.drift = {9}}, "fit: axis = 9: must be one of the variables");
  expect({.kernel = "wu-c0"}, "not in 20");
  const Eigen::MatrixXd most(21, 10);
  expect_refusal([&] { fit_function(most, Eigen::MatrixXd::Zero(10, 1), Eigen::VectorXd()); },
                 "fit: dimension = 21: must be 1 to 20");
}

}  // namespace
}  // namespace csrbf::many_variables_test
