#include "csrbf/approx/fit.hpp"

#include "approx/approx_testing.hpp"

#include <numbers>

namespace csrbf::fit_test {
namespace {

constexpr double solved = 1e-6;  // of values of size 1, through systems of condition up to about 1e9

// The root mean square error at 500 random points of the inner 80 % of the box of f.
template <int Dim, class Function>
double inner_error(const Field<Dim>& f, const Function& function) {
  const Box<Dim> box = f.bounds();
  Points<Dim> x = (0.1 + 0.8 * random_points<Dim>(500, 9).array()).matrix();
  for (Index i = 0; i < x.cols(); ++i) x.col(i) = box.lo + x.col(i).cwiseProduct(box.extent());
  const Samples<Dim> truth = sample<Dim>(x, function);
  return (f.evaluate(x).value - truth.values.col(0)).norm() / std::sqrt(500.0);
}

template <int Dim>
void expect_every_method() {
  const Samples<Dim> data = sample<Dim>(random_points<Dim>(300, 1), waves<Dim>);
  for (const std::string& method : fit_methods()) {
    if (method == "auto") continue;
    const Fit<Dim> result = fit<Dim>(data, {.method = method});
    EXPECT_EQ(result.report.method, method);
    EXPECT_EQ(result.report.samples, 300);
    EXPECT_FALSE(result.report.kernel.empty());
    EXPECT_EQ(result.report.axis_scales.size(), static_cast<std::size_t>(Dim));
    ASSERT_EQ(result.components.size(), 1U);
    EXPECT_NEAR(result.report.max_error, largest_error<Dim>(*result.components[0], data), 1e-12) << method;
    EXPECT_LE(result.report.rmse, result.report.max_error) << method;
    EXPECT_LE(inner_error<Dim>(*result.components[0], waves<Dim>), .2) << Dim << " " << method;
    EXPECT_THROW(fit<Dim>(data, {.method = method, .progress = [](std::string_view, double) { return false; }}),
                 Cancelled);
  }
}

TEST(Fit, OffersEveryMethodInEveryDimension) {
  expect_every_method<1>();
  expect_every_method<2>();
  expect_every_method<3>();
}

TEST(Fit, ChoosesTheMethodByTheTask) {
  const Samples<2> few = sample<2>(random_points<2>(300, 1), franke);
  const Samples<2> many = sample<2>(random_points<2>(6000, 1), franke);
  EXPECT_EQ(fit<2>(few).report.method, "interpolate");
  EXPECT_EQ(fit<2>(many).report.method, "partition-of-unity");
  EXPECT_EQ(fit<4>(sample<4>(random_points<4>(600, 1), waves<4>)).report.method, "interpolate");
  EXPECT_EQ(fit<2>(few, {.tolerance = .01}).report.method, "error-bounded");
  EXPECT_EQ(fit<2>(few, {.centers = 40}).report.method, "fixed-budget");
  EXPECT_EQ(fit<2>(few, {.centers = 40, .tolerance = .01}).report.method, "error-bounded");
  EXPECT_EQ(fit<2>(few, {.centers = 40}).report.centers, 40);
}

TEST(Fit, MeetsExactValuesWithoutOptions) {
  const Samples<2> few = sample<2>(random_points<2>(300, 1), franke);
  const Fit<2> interpolant = fit<2>(few);
  EXPECT_LE(interpolant.report.max_error, solved);
  EXPECT_LE(inner_error<2>(*interpolant.components[0], franke), 5e-3);
  const Fit<2> partition = fit<2>(sample<2>(random_points<2>(8000, 1), franke));
  EXPECT_LE(partition.report.max_error, 1e-4);
  EXPECT_LE(inner_error<2>(*partition.components[0], franke), 1e-5);
}

TEST(Fit, SmoothsNoiseWithoutOptions) {
  constexpr double sigma = .05;
  std::mt19937_64 random(5);
  std::normal_distribution<double> error(0, sigma);
  for (const Index n : {400, 4000}) {
    Samples<2> data = sample<2>(random_points<2>(n, 1), franke);
    for (Index i = 0; i < n; ++i) data.values(i) += error(random);
    const Fit<2> result = fit<2>(data);
    EXPECT_LE(inner_error<2>(*result.components[0], franke), .6 * sigma) << n;
    EXPECT_NEAR(result.report.rmse, sigma, .35 * sigma) << n;
    EXPECT_NEAR(result.report.cross_validation_rmse, sigma, .35 * sigma) << n;
  }
}

TEST(Fit, DoesNotFollowPureNoise) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise;
  for (int repetition = 0; repetition < 4; ++repetition) {
    Samples<3> data{random_points<3>(150, repetition), Eigen::MatrixXd(150, 1), {}};
    for (double& value : data.values.reshaped()) value = 7 + noise(random);
    const Fit<3> result = fit<3>(data);
    const auto mean = [](const Point<3>&) { return 7.; };
    EXPECT_LE(inner_error<3>(*result.components[0], mean), .3) << repetition;
    EXPECT_GE(result.report.rmse, .6) << repetition;
  }
}

TEST(Fit, HoldsTheToleranceAtEverySample) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> error(0, .05);
  Samples<2> data = sample<2>(random_points<2>(600, 1), franke);
  for (Index i = 0; i < 600; ++i) data.values(i) += error(random);
  data.points.col(7) = data.points.col(8);  // both are met
  data.values(7) = data.values(8) + .01;
  for (const double tolerance : {.1, .02}) {
    const Fit<2> result = fit<2>(data, {.tolerance = tolerance});
    EXPECT_LE(largest_error<2>(*result.components[0], data), tolerance * (1 + solved));
    EXPECT_LE(result.report.max_error, tolerance * (1 + solved));
    EXPECT_TRUE(result.report.warnings.empty());
  }
  data.values(7) = data.values(8) + 1;
  EXPECT_THROW(fit<2>(data, {.tolerance = .1}), SolverFailure);
}

TEST(Fit, KeepsNothingOfAttemptsThatMissTheTolerance) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> error(0, .05);
  Samples<2> data = sample<2>(random_points<2>(1500, 1), franke);
  for (Index i = 0; i < data.size(); ++i) data.values(i) += error(random);
  const Fit<2> result = fit<2>(data, {.tolerance = .02});
  EXPECT_EQ(result.report.method, "error-bounded");
  EXPECT_EQ(result.report.samples_fitted, data.size());
  EXPECT_FALSE(result.report.partition);
  EXPECT_TRUE(result.variances.empty());
}

TEST(Fit, TakesAsManySamplesAsAToleranceNeeds) {
  Samples<2> data = sample<2>(random_points<2>(40'000, 1), franke);
  data.points.col(7) = data.points.col(8);
  data.values(7) = data.values(8);
  Index before = 0;
  for (const double tolerance : {1e-2, 1e-4, 1e-8}) {
    const Fit<2> result = fit<2>(data, {.tolerance = tolerance});
    EXPECT_EQ(result.report.method, "partition-of-unity") << tolerance;
    EXPECT_LE(largest_error<2>(*result.components[0], data), tolerance);
    EXPECT_EQ(result.report.samples, data.size());
    EXPECT_GE(result.report.samples_fitted, before);
    before = result.report.samples_fitted;
  }
  EXPECT_LT(fit<2>(data, {.tolerance = 1e-2}).report.samples_fitted, data.size() / 50);
  EXPECT_EQ(before, data.size() - 1);
}

TEST(Fit, MergesDuplicates) {
  Samples<2> data = sample<2>(random_points<2>(200, 1), franke);
  const Samples<2> single = data;
  data.points.conservativeResize(Eigen::NoChange, 250);
  data.values.conservativeResize(250, Eigen::NoChange);
  for (Index i = 0; i < 50; ++i) {
    data.points.col(200 + i) = data.points.col(i);
    data.values(200 + i) = single.values(i) + .2;
    data.values(i) -= .2;
  }
  for (const std::string method : {"interpolate", "partition-of-unity", "least-squares", "moving-least-squares"}) {
    const Fit<2> merged = fit<2>(data, {.method = method, .smoothing = 0});
    EXPECT_EQ(merged.report.merged_duplicates, 50) << method;
    EXPECT_EQ(merged.report.samples, 200) << method;
    EXPECT_NEAR(merged.report.max_error, .2, .2) << method;
  }
  const Fit<2> interpolant = fit<2>(data, {.method = "interpolate", .smoothing = 0});
  EXPECT_LE(largest_error<2>(*interpolant.components[0], single), solved);
}

TEST(Fit, TakesAllSamplesAtOnePoint) {
  const Samples<3> data{Points<3>::Constant(3, 10, 2), Eigen::VectorXd::LinSpaced(10, 0, 9), {}};
  for (const std::string method : {"auto", "interpolate", "partition-of-unity", "moving-least-squares"}) {
    const Fit<3> result = fit<3>(data, {.method = method});
    EXPECT_EQ(result.report.samples, 1) << method;
    EXPECT_NEAR((*result.components[0])(Point<3>(2, 2, 2)), 4.5, solved) << method;
    EXPECT_NEAR((*result.components[0])(Point<3>(5, 5, -1e9)), 4.5, solved) << method;
  }
}

TEST(Fit, FitsComponentsTogether) {
  Samples<2> data = sample<2>(random_points<2>(300, 1), franke);
  data.values.conservativeResize(Eigen::NoChange, 3);
  data.values.col(1) = 3 + data.values.col(0).array();
  data.values.col(2) = sample<2>(data.points, waves<2>).values;
  for (const std::string& method : fit_methods()) {
    const Fit<2> result = fit<2>(data, {.method = method, .kernel = "wendland-c2"});
    ASSERT_EQ(result.components.size(), 3U);
    EXPECT_LE(inner_error<2>(*result.components[0], franke), .2) << method;
    EXPECT_LE(inner_error<2>(*result.components[2], waves<2>), .3) << method;
    if (method != "auto") {
      EXPECT_EQ(result.report.kernel, "wendland-c2");
    }
  }
}

// Longitude and latitude; the samples reach the seam from both sides.
Samples<2> globe(Index count, double west) {
  Points<2> points = random_points<2>(count, 1);
  points.row(0) = (west + 360 * points.row(0).array()).matrix();
  points.row(1) = (120 * points.row(1).array() - 60).matrix();
  return sample<2>(points, [](const Point<2>& p) {
    const Point<2> angle = p * (std::numbers::pi / 180);
    return std::sin(angle[0] - 1) * std::cos(angle[1]) + .5 * std::cos(3 * angle[0]) + angle[1];
  });
}

TEST(Fit, ContinuesAcrossTheSeamOfAPeriod) {
  for (const Index n : {400, 4000})
    for (const double west : {0.0, -180.0}) {
      const auto f = fit<2>(globe(n, west), {.periods = {360, 0}}).components[0];
      const Samples<2> truth = globe(2000, west);
      const Samples<2> other = globe(5000, west);
      double seam = 0, elsewhere = 0;
      const Eigen::VectorXd error = (f->evaluate(other.points).value - other.values.col(0)).cwiseAbs();
      for (Index i = n; i < other.size(); ++i) {
        const double lon = other.points(0, i) - west;
        double& most = lon < 10 || lon > 350 ? seam : elsewhere;
        if (std::abs(other.points(1, i)) < 50) most = std::max(most, error[i]);
      }
      EXPECT_LE(seam, 2 * elsewhere) << n;
      EXPECT_LE(elsewhere, n > 1000 ? 1e-3 : 1e-1) << n;
      const Points<2> later = truth.points.colwise() + Point<2>(720, 0);
      EXPECT_LE((f->evaluate(later).value - f->evaluate(truth.points).value).cwiseAbs().maxCoeff(), 1e-7)
          << n;  // wrapped coordinates differ in the last digits, which the sum of the ill-conditioned system magnifies
    }
}

TEST(Fit, IsContinuousAtTheSeamToTheLastDigits) {
  for (const std::string method : {"partition-of-unity", "interpolate"}) {
    const auto f =
        fit<2>(globe(250, 0), {.method = method, .kernel = "wendland-c2", .periods = {360, 0}}).components[0];
    const double first = f->bounds().lo[0];
    Points<2> before(2, 50), at(2, 50);
    for (Index i = 0; i < 50; ++i) {
      before.col(i) << std::nextafter(first, -1), -50 + 2 * static_cast<double>(i);
      at.col(i) << first, before(1, i);
    }
    const Jet<2> left = f->evaluate(before, Derivatives::gradient), right = f->evaluate(at, Derivatives::gradient);
    EXPECT_LE((left.value - right.value).cwiseAbs().maxCoeff(), 1e-12) << method;
    EXPECT_LE((left.gradient - right.gradient).cwiseAbs().maxCoeff(), 1e-12) << method;
  }
}

TEST(Fit, CountsSamplesNearTheSeamOnce) {
  Samples<2> data = globe(300, 0);
  data.points.col(1) = data.points.col(0) + Point<2>(360, 0);  // the same place
  data.points(0, 3) = data.points(0, 2) = 1;
  data.points(1, 3) = data.points(1, 2);
  const Fit<2> result = fit<2>(data, {.method = "partition-of-unity", .periods = {360, 0}, .loss = "squares"});
  EXPECT_EQ(result.report.merged_duplicates, 2);
  EXPECT_EQ(result.report.samples, 298);
}

TEST(Fit, ScalesAxesOfDifferentUnits) {
  for (const std::string method : {"partition-of-unity", "interpolate", "multilevel"}) {
    const Samples<2> data = sample<2>(random_points<2>(600, 1), franke);
    const double error = inner_error<2>(*fit<2>(data, {.method = method}).components[0], franke);
    for (const double unit : {1e-6, 1e3}) {
      Samples<2> other = data;
      other.points.row(1) *= unit;
      const Fit<2> result = fit<2>(other, {.method = method});
      EXPECT_NEAR(result.report.axis_scales[1] / result.report.axis_scales[0], unit, .02 * unit);
      const auto function = [&](const Point<2>& p) { return franke(Point<2>(p[0], p[1] / unit)); };
      // Extents differ a little after scaling, so cross-validation may choose otherwise; unscaled, errors are above
      // .01.
      EXPECT_LE(inner_error<2>(*result.components[0], function), 10 * error + solved) << method << " " << unit;
      const Points<2> x = (random_points<2>(30, 4).array() * Eigen::Array2d(1, unit).replicate(1, 30)).matrix();
      const Jet<2> jet = result.components[0]->evaluate(x, Derivatives::gradient);
      const Point<2> step(0, 1e-6 * unit);
      const Points<2> ahead = x.colwise() + step, behind = x.colwise() - step;
      const Eigen::VectorXd slope =
          (result.components[0]->evaluate(ahead).value - result.components[0]->evaluate(behind).value) / 2e-6;
      EXPECT_LE((jet.gradient.row(1).transpose() * unit - slope).cwiseAbs().maxCoeff(), 1e-2)
          << method;  // differences of an ill-conditioned sum
    }
  }
}

TEST(Fit, FindsTheDirectionsInWhichValuesChange) {
  const Point<2> u(std::cos(0.6), std::sin(0.6)), v(-u.y(), u.x());
  const auto function = [&](const Point<2>& p) { return std::sin(40 * u.dot(p)) + .3 * std::cos(2 * v.dot(p)); };
  const Samples<2> data = sample<2>(random_points<2>(900, 1), function);
  const Fit<2> result = fit<2>(data);
  ASSERT_EQ(result.report.axes.size(), 2U);
  EXPECT_NEAR(std::abs(result.report.axes[1][0]), std::cos(0.6), 0.01);
  EXPECT_GT(result.report.axis_scales[0], 10 * result.report.axis_scales[1]);
  EXPECT_LE(inner_error<2>(*result.components[0], function), 1e-4);  // along the coordinates 1e-2
  EXPECT_LE(largest_error<2>(*result.components[0], data), 1e-5);
  expect_true_derivatives<2>(*result.components[0], random_points<2>(5, 4), 1e-4, 1);
  EXPECT_TRUE(fit<2>(data, {.scale_axes = false}).report.axes.empty());
}

TEST(Fit, LeavesAxesOfOneUnitAlone) {
  Samples<2> data = sample<2>(random_points<2>(300, 1), franke);
  EXPECT_NEAR(fit<2>(data).report.axis_scales[1] / fit<2>(data).report.axis_scales[0], 1, .1);
  EXPECT_EQ(fit<2>(data, {.method = "multilevel"}).report.axis_scales, (std::vector<double>{1, 1}));
  data.points.row(1) *= 100;
  EXPECT_EQ(fit<2>(data, {.scale_axes = false}).report.axis_scales, (std::vector<double>{1, 1}));
}

TEST(Fit, IsConstantOrUndefinedBeyondItsSamples) {
  for (const Index n : {300, 1500}) {
    const Samples<2> data = sample<2>(random_points<2>(n, 1), franke);
    const auto constant = fit<2>(data, {.extrapolation = Extrapolation::constant}).components[0];
    const auto undefined = fit<2>(data, {.extrapolation = Extrapolation::nan}).components[0];
    const Box<2> box = bounding_box<2>(data.points);
    EXPECT_EQ(constant->bounds().lo, box.lo);
    EXPECT_EQ((*constant)(Point<2>(7, .5)), (*constant)(Point<2>(box.hi[0], .5)));
    EXPECT_EQ((*constant)(Point<2>(-1, -1)), (*constant)(box.lo));
    EXPECT_TRUE(std::isnan((*undefined)(Point<2>(7, .5))));
    EXPECT_TRUE(std::isnan((*undefined)(Point<2>(.5, box.lo[1] - 1e-9))));
    EXPECT_EQ((*undefined)(Point<2>(.5, .5)), (*constant)(Point<2>(.5, .5)));
    EXPECT_EQ((*undefined)(box.hi), (*constant)(box.hi));
  }
}

// Queries of the same distribution as many samples lie outside their box, too, though not far.
TEST(Fit, FollowsSlopesALittleBeyondManySamples) {
  for (const Index n : {1500, 5000}) {
    const auto wave = [](const Point<2>& p) { return std::sin(3 * p[0] - p[1]); };
    const auto f = fit<2>(sample<2>(random_points<2>(n, 1), wave)).components[0];
    const Box<2> box = f->bounds();
    const double rim = 1 / std::sqrt(static_cast<double>(n));
    for (const double y : {.2, .5, .8}) {
      const Point<2> x(box.hi[0] + .3 * rim, y);
      EXPECT_NEAR((*f)(x), wave(x), 1e-3) << n;
      EXPECT_EQ((*f)(Point<2>(2, y)), (*f)(Point<2>(3, y))) << n;
    }
  }
}

TEST(Fit, CanBeCancelledLate) {
  const Samples<2> data = sample<2>(random_points<2>(3000, 1), franke);
  Index calls = 0;
  (void)fit<2>(data, {.progress = [&](std::string_view stage, double fraction) {
                 EXPECT_FALSE(stage.empty());
                 EXPECT_TRUE(fraction >= 0 && fraction <= 1);
                 return ++calls > 0;
               }});
  EXPECT_GT(calls, 3);
  Index left = calls - 1;
  EXPECT_THROW(fit<2>(data, {.progress = [&](std::string_view, double) { return --left > 0; }}), Cancelled);
}

TEST(Fit, RefusesInvalidSamples) {
  const Samples<2> good = sample<2>(random_points<2>(50, 1), franke);
  const auto refused = [](const Samples<2>& data, const std::string& part) {
    expect_refusal([&] { fit<2>(data); }, "fit: " + part);
  };
  refused({Points<2>(2, 0), Eigen::MatrixXd(0, 1), {}}, "samples = none: at least one");
  refused({good.points, good.values.topRows(49), {}}, "values = 49: there must be one row of values per point");
  refused({good.points, Eigen::MatrixXd(50, 0), {}}, "values = 0 columns");
  refused({good.points, good.values, Eigen::VectorXd::Ones(3)}, "weights = 3: there must be one weight per point");
  refused({good.points, good.values, -Eigen::VectorXd::Ones(50)}, "weights = negative or not finite");
  refused({good.points, good.values, Eigen::VectorXd::Zero(50)}, "weights = all zero");
  Samples<2> bad = good;
  bad.values(3) = std::nan("");
  refused(bad, "values = NaN or infinity");
  bad = good;
  bad.points(0, 3) = HUGE_VAL;
  refused(bad, "points = NaN or infinity");
}

TEST(Fit, RefusesInvalidOptions) {
  const Samples<2> data = sample<2>(random_points<2>(50, 1), franke);
  const auto refused = [&](const FitOptions& options, const std::string& part) {
    expect_refusal([&] { fit<2>(data, options); }, part);
  };
  refused({.method = "kriging"}, "fit: method = kriging: unknown; use one of auto, interpolate, ");
  refused({.kernel = "wenland"}, "wendland-c2");
  refused({.method = "partition-of-unity", .kernel = "thin-plate"}, "kernel = thin-plate: is only conditionally");
  refused({.kernel = "gaussian", .kernel_parameter = 2}, "gaussian");
  refused({.method = "partition-of-unity", .kernel = "matern", .kernel_parameter = 2},
          "fit: kernel_parameter = 2: is for");
  refused({.centers = -1}, "fit: centers = -1");
  refused({.tolerance = -1}, "fit: tolerance = -1");
  refused({.tolerance = std::nan("")}, "fit: tolerance = nan");
  refused({.smoothing = -1}, "fit: smoothing = -1");
  refused({.smoothing = HUGE_VAL}, "fit: smoothing = inf");
  refused({.degree = -2}, "fit: degree = -2");
  refused({.degree = 9}, "fit: degree = 9");
  refused({.periods = {360}}, "fit: periods = 1: one per axis");
  refused({.periods = {360, -1}}, "fit: periods = -1");
  refused({.periods = {360, std::nan("")}}, "fit: periods = nan");
}

TEST(Fit, WarnsWhereRoundingErrorsExceedTheTolerance) {
  Samples<1> samples{Points<1>(1, 60), Eigen::MatrixXd(60, 1), {}};
  for (Index i = 0; i < 60; ++i) {
    samples.points(0, i) = static_cast<double>(i);
    samples.values(i, 0) = 1e120 * std::sin(static_cast<double>(i * i));
  }
  const auto result = fit<1>(samples, {.method = "multilevel", .tolerance = 1e100});
  ASSERT_GT(result.report.max_error, 1e100);
  ASSERT_EQ(result.report.warnings.size(), 1U);
  EXPECT_EQ(result.report.warnings.front(), "the tolerance does not hold at every sample");
}

}  // namespace
}  // namespace csrbf::fit_test
