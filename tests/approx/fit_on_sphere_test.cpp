#include "csrbf/approx/fit_on_sphere.hpp"

#include "approx/approx_testing.hpp"
#include "csrbf/approx/fit.hpp"

#include <numbers>

namespace csrbf::fit_on_sphere_test {
namespace {

constexpr double to_radians = std::numbers::pi / 180;

// A smooth function on the sphere, of size 1, from its longitude and latitude.
double on_sphere(const Point<2>& x) {
  const Point<3> u = point_on_sphere(x[0], x[1]);
  return std::sin(2 * u[0] + u[1]) * std::cos(3 * u[2] - u[1]) + .3 * u[0] * u[2];
}

// Evenly distributed over the sphere, longitudes from `first` on.
Points<2> sphere_points(Index n, unsigned seed, double first = -180) {
  const Points<2> r = random_points<2>(n, seed);
  Points<2> x(2, n);
  for (Index i = 0; i < n; ++i) x.col(i) << first + 360 * r(0, i), std::asin(2 * r(1, i) - 1) / to_radians;
  return x;
}

Eigen::VectorXd normal_values(Index n, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  return Eigen::VectorXd::NullaryExpr(n, [&] { return normal(random); });
}

double sphere_error(const Field<2>& f) {
  Points<2> x = sphere_points(2000, 7);
  x.col(0) << 17, 90;
  x.col(1) << 17, -90;
  x.col(2) << 180, 12;
  x.col(3) << -180, 12;
  const Samples<2> truth = sample<2>(x, on_sphere);
  return largest_error<2>(f, truth);
}

const FitOptions spherical = {.sphere = {0, 1}};

// Rounding errors, which systems magnify.
constexpr double rounding = 1e-7;

void expect_one_value_at_the_poles_and_at_the_date_line(const Field<2>& f) {
  for (const double latitude : {90., -90.}) {
    const double value = f(Point<2>(0, latitude));
    for (const double longitude : {-180., -90., 33., 271.}) EXPECT_NEAR(f(Point<2>(longitude, latitude)), value, 1e-13);
    EXPECT_NEAR(f(Point<2>(50, .999999999 * latitude)), value, 1e-7);
  }
  EXPECT_NEAR(f(Point<2>(180, 40)), f(Point<2>(-180, 40)), 1e-13);
}

// One system of few samples, and charts of more. Each is fitted once, for all that holds of both.
TEST(FitOnSphere, MeetsASmoothFunctionEverywhere) {
  const Points<2> x = sphere_points(500, 3);
  Points<2> turned = x;
  turned.row(0).array() += 720;
  for (const Index n : {300, 2600}) {
    SCOPED_TRACE(n);
    const Fit<2> result = fit<2>(sample<2>(sphere_points(n, 1), on_sphere), spherical);
    const Field<2>& f = *result.components[0];
    EXPECT_LE(sphere_error(f), 1e-6);
    EXPECT_LE((f.evaluate(x).value - f.evaluate(turned).value).cwiseAbs().maxCoeff(), rounding);
    expect_one_value_at_the_poles_and_at_the_date_line(f);
    expect_true_derivatives<2>(f, sphere_points(100, 5), 1e-2, 1e-6);  // per degree
  }
}

TEST(FitOnSphere, HasABoxAcrossTheDateLineThatHoldsTheSamplesAlone) {
  Points<2> x = random_points<2>(200, 1);
  for (Index i = 0; i < x.cols(); ++i) {
    x.col(i) << 170 + 20 * x(0, i), -50 + 20 * x(1, i);
    if (x(0, i) > 180) x(0, i) -= 360;
  }
  const Fit<2> result = fit<2>(sample<2>(x, on_sphere), spherical);
  const Box<2> box = result.components[0]->bounds();
  EXPECT_GE(box.lo[0], 170);
  EXPECT_LE(box.hi[0], 190);
  EXPECT_GE(box.extent()[0], 19);
  const Point<2> beyond(185, -40), usual(-175, -40);
  EXPECT_NEAR((*result.components[0])(beyond), on_sphere(usual), 1e-5);
  EXPECT_EQ((*result.components[0])(beyond), (*result.components[0])(usual));
}

TEST(FitOnSphere, HasTheBoxOfItsSamplesAllAround) {
  for (const double first : {-180., 0.}) {
    const Box<2> box = fit<2>(sample<2>(sphere_points(300, 1, first), on_sphere), spherical).components[0]->bounds();
    EXPECT_NEAR(box.lo[0], first, 10);
    EXPECT_NEAR(box.hi[0], first + 360, 10);
  }
}

TEST(FitOnSphere, DoesNotDependOnWhereLongitudesJump) {
  const Samples<2> samples = sample<2>(sphere_points(300, 1), on_sphere);
  Samples<2> other = samples;
  for (double& longitude : other.points.row(0))
    if (longitude < 0) longitude += 360;
  const Fit<2> one = fit<2>(samples, spherical), two = fit<2>(other, spherical);
  const Points<2> x = sphere_points(500, 3);
  EXPECT_LE((one.components[0]->evaluate(x).value - two.components[0]->evaluate(x).value).cwiseAbs().maxCoeff(),
            rounding);
}

TEST(FitOnSphere, FitsARegionAcrossTheDateLineInOneChart) {
  Points<2> x = random_points<2>(600, 4);
  for (Index i = 0; i < x.cols(); ++i) x.col(i) << (i % 2 == 0 ? 160 : -200) + 40 * x(0, i), -60 + 40 * x(1, i);
  const auto f = fit<2>(sample<2>(x, on_sphere), spherical).components[0];
  Points<2> at(2, 2);
  at << 179.9, -179.9, -40, -40;
  EXPECT_LE(largest_error<2>(*f, sample<2>(at, on_sphere)), 1e-6);
}

TEST(FitOnSphere, TakesFurtherCoordinates) {
  const auto function = [](const Point<3>& x) { return on_sphere(Point<2>(x[2], x[1])) + std::sin(3 * x[0]); };
  Points<3> x(3, 900);
  const Points<2> places = sphere_points(900, 8);
  x.row(0) = random_points<1>(900, 9);
  x.row(1) = places.row(1);
  x.row(2) = places.row(0);
  const Fit<3> result = fit<3>(sample<3>(x, function), {.sphere = {2, 1}});
  EXPECT_EQ(result.report.axis_scales.size(), 3U);
  EXPECT_LE(largest_error<3>(*result.components[0], sample<3>(x, function)), 1e-4);
  EXPECT_NEAR((*result.components[0])(Point<3>(.5, 80, 12)), function(Point<3>(.5, 80, 12)), 1e-3);
}

TEST(FitOnSphere, HasDeviationsThatHoldTheErrors) {
  Samples<2> data = sample<2>(sphere_points(300, 2), on_sphere);
  data.values += .05 * normal_values(300, 11);
  const Fit<2> result = fit<2>(data, spherical);
  ASSERT_EQ(result.variances.size(), 1U);
  EXPECT_NEAR(std::sqrt(result.variances[0]->evaluate(sphere_points(300, 3)).value.mean()), .05, .01);
}

TEST(FitOnSphere, NamesWhatIsWrong) {
  Samples<2> data = sample<2>(sphere_points(30, 2), on_sphere);
  EXPECT_THROW(fit<2>(data, {.sphere = {0}}), InvalidInput);
  EXPECT_THROW(fit<2>(data, {.sphere = {0, 2}}), InvalidInput);
  EXPECT_THROW(fit<2>(data, {.periods = {360, 0}, .sphere = {0, 1}}), InvalidInput);
  data.points(1, 3) = 91;
  EXPECT_THROW(fit<2>(data, spherical), InvalidInput);
}

}  // namespace
}  // namespace csrbf::fit_on_sphere_test
