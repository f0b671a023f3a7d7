#include "csrbf/approx/fit.hpp"

#include "approx/approx_testing.hpp"

namespace csrbf::far_samples_test {
namespace {

double wave(double x, double y) {
  return std::sin(5 * x) * std::cos(4 * y) + x;
}

// Samples in the unit cube, and perhaps one more on its diagonal.
template <int Dim>
Fit<Dim> fit_with(Index n, std::optional<double> far) {
  Points<Dim> x = random_points<Dim>(n + (far ? 1 : 0), 7);
  if (far) x.col(n).setConstant(*far);
  Samples<Dim> data = sample<Dim>(x, [](const Point<Dim>& p) { return wave(p[0], p[Dim - 1]); });
  if (far) data.values(n) = 1;
  return fit<Dim>(data);
}

template <int Dim>
double error_in_cube(const Fit<Dim>& fit) {
  const Points<Dim> x = .05 + .9 * random_points<Dim>(2000, 8).array();
  double sum = 0;
  const Eigen::VectorXd f = fit.components[0]->evaluate(x).value;
  for (Index i = 0; i < x.cols(); ++i) sum += std::pow(f[i] - wave(x(0, i), x(Dim - 1, i)), 2);
  return std::sqrt(sum / 2000);
}

// A station with a wrong coordinate: cells between it and the others are large, and reach into these.
template <int Dim>
void leaves_the_others(Index n, double most, const std::vector<double>& distances = {10, 1e4}) {
  for (const double far : distances) {
    const Fit<Dim> result = fit_with<Dim>(n, far);
    EXPECT_LE(error_in_cube<Dim>(result), most) << far;
    EXPECT_LE(result.report.rmse, 1e-5) << far;
  }
}

TEST(FarSample, LeavesTheOthersAsTheyAre) {
  leaves_the_others<1>(6000, 1e-8);
  leaves_the_others<2>(2600, 1e-4);
  leaves_the_others<3>(2600, 5e-4, {1e4});
}

TEST(FarSample, IsReachedWithoutOvershoot) {
  for (const double far : {6.0, 1e4}) {
    const Fit<1> result = fit_with<1>(3000, far);
    for (double t = 1.2; t < far; t *= 1.3) {
      const Point<1> at(t);
      const double value = (*result.components[0])(at), deviation = std::sqrt((*result.variances[0])(at));
      EXPECT_GE(value, -.5) << t;  // the samples are in [0, 1.4]
      EXPECT_LE(value, 1.9) << t;
      EXPECT_GE(deviation, .02) << t;
      EXPECT_LE(deviation, 2) << t;
    }
  }
}

// The most usual wrong coordinate: of one axis, which then seems to have a unit of its own.
TEST(FarSample, AlongOneAxisLeavesTheOthersAndIsNamed) {
  const auto waves = [](const Point<2>& p) { return std::sin(9 * p[0] + 4 * p[1]); };
  const Points<2> places = .05 + .9 * random_points<2>(500, 8).array();
  for (const Index n : {60, 600, 2600}) {
    Points<2> x = random_points<2>(n + 1, 7);
    x(0, n) = 1e3;
    Samples<2> data = sample<2>(x, waves);
    data.values(n) = .3;
    const Fit<2> result = fit<2>(data);
    const Eigen::VectorXd error = result.components[0]->evaluate(places).value - sample<2>(places, waves).values.col(0);
    EXPECT_LE(error.cwiseAbs().maxCoeff(), n < 100 ? .05 : 1e-3) << n;
    ASSERT_EQ(result.report.warnings.size(), 1U) << n;
    EXPECT_NE(result.report.warnings[0].find("a coordinate far from those of all others (number " +
                                             std::to_string(n + 1) + ")"),
              std::string::npos)
        << result.report.warnings[0];
  }
}

// Local functions of few samples cannot tell by their own radius what a gap is.
TEST(GapInOneDimension, IsBridgedAndLeavesTheRest) {
  for (const Index n : {3000, 20'000}) {
    Points<1> x = random_points<1>(n, 7);
    for (double& t : x.reshaped()) t = t < .5 ? .6 * t : .8 + .4 * (t - .5);
    const Fit<1> result = fit<1>(sample<1>(x, [](const Point<1>& p) { return wave(p[0], p[0]); }));
    EXPECT_LE(result.report.rmse, 1e-6);
    Index held = 0;
    for (int k = 0; k < 100; ++k) {
      const double t = .3 + .005 * k;
      const double error = (*result.components[0])(Point<1>(t)) - wave(t, t);
      EXPECT_LE(std::abs(error), .2) << t;
      held += std::abs(error) <= 1.96 * std::sqrt((*result.variances[0])(Point<1>(t))) ? 1 : 0;
    }
    EXPECT_GE(held, 90);
  }
}

}  // namespace
}  // namespace csrbf::far_samples_test
