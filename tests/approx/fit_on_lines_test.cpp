#include "csrbf/approx/fit.hpp"

#include "approx/approx_testing.hpp"
#include "csrbf/approx/moving/on_lines.hpp"

namespace csrbf::fit_on_lines_test {
namespace {

// Vertical wells in the unit cube, seen `each` times, the first coordinate stretched.
Points<3> wells(Index count, Index each, double stretch = 1) {
  const Points<2> places = random_points<2>(count, 3);
  Points<3> x(3, count * each);
  for (Index w = 0; w < count; ++w)
    for (Index k = 0; k < each; ++k)
      x.col(each * w + k) << stretch * places(0, w), places(1, w),
          static_cast<double>(k) / static_cast<double>(each - 1);
  return x;
}

double layers(const Point<3>& p) {
  return std::sin(13 * p[2] + 2.5 * p[0]) + p[1];
}

TEST(OnLines, TellsWellsFromScatteredPoints) {
  EXPECT_TRUE(on_lines<3>(wells(25, 200)));
  EXPECT_TRUE(on_lines<3>(wells(25, 200, 1e-3)));
  EXPECT_TRUE(on_lines<3>(wells(25, 200, 1e3)));
  EXPECT_FALSE(on_lines<3>(random_points<3>(5000, 1)));
  EXPECT_FALSE(on_lines<2>(unit_grid(60)));
  EXPECT_FALSE(on_lines<1>(random_points<1>(1000, 1)));
}

// Patches of wells seen densely hold samples of one of them alone.
TEST(FitOnLines, IsAsGoodWithMoreSamplesOnThem) {
  for (const Index each : {50, 120}) {
    const Fit<3> result = fit<3>(sample<3>(wells(25, each), layers));
    EXPECT_LE(rms_error<3>(*result.components[0], layers), 1e-2) << each;
    EXPECT_LE(result.report.max_error, 1e-4) << each;
  }
}

TEST(FitOnLines, AveragesNoise) {
  Samples<3> data = sample<3>(wells(25, 120), layers);
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal(0, .05);
  for (double& value : data.values.reshaped()) value += normal(random);
  const Fit<3> result = fit<3>(data);
  EXPECT_LE(rms_error<3>(*result.components[0], layers), .03);
  EXPECT_NEAR(result.report.noise[0], .05, .01);
  EXPECT_NEAR(std::sqrt((*result.variances[0])(Point<3>(.5, .5, .5))), .05, .01);
}

// One system of some of the samples alone has as much noise as these.
TEST(FitOnLines, AveragesNoiseOfAllSamples) {
  Points<2> x(2, 20 * 600);
  for (Index i = 0; i < x.cols(); ++i) {
    const double t = static_cast<double>(i % 600) / 600;
    x.col(i) << t, (static_cast<double>(i / 600) + .2 * t) / 20;
  }
  const auto wave = [](const Point<2>& p) { return std::sin(5 * p[0]) * std::cos(4 * p[1]); };
  Samples<2> data = sample<2>(x, wave);
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal(0, .3);
  for (double& value : data.values.reshaped()) value += normal(random);
  const Fit<2> result = fit<2>(data);
  EXPECT_LE(rms_error<2>(*result.components[0], wave), .022);
  EXPECT_EQ(result.report.samples_fitted, x.cols());
}

// What is finer than one system resolves.
TEST(FitOnLines, FollowsWhatIsFinerAlongThem) {
  const auto fine = [](const Point<3>& p) { return layers(p) + .04 * std::sin(180 * p[2]); };
  const Fit<3> result = fit<3>(sample<3>(wells(12, 300), fine));
  EXPECT_LE(result.report.rmse, 3e-3);
}

// Left out one by one, samples are predicted well along their tracks by patches, which do not know what is between.
TEST(FitOnLines, ChoosesByWhatIsBetweenThem) {
  Points<2> x(2, 960);
  for (Index i = 0; i < x.cols(); ++i) {
    const double t = static_cast<double>(i % 80) / 79;
    x.col(i) << t, (static_cast<double>(i / 80) + .3 * t) / 12;
  }
  const auto waves = [](const Point<2>& p) {
    return std::sin(4 * p[0] + 1) * std::cos(3 * p[1]) + .2 * std::sin(75 * p[0] + 20 * p[1]) * std::cos(70 * p[1] + 1);
  };
  const Fit<2> result = fit<2>(sample<2>(x, waves));
  EXPECT_EQ(result.report.method, "interpolate");
  const Points<2> places = random_points<2>(1000, 2);
  const Eigen::VectorXd f = result.components[0]->evaluate(places).value,
                        v = result.variances[0]->evaluate(places).value;
  Index within = 0;
  for (Index i = 0; i < places.cols(); ++i)
    within += std::abs(f[i] - waves(places.col(i))) <= 1.96 * std::sqrt(v[i]) ? 1 : 0;
  EXPECT_GE(within, 900);
}

// A road along an axis of the map: one coordinate has no extent, and no slope.
TEST(FitOnLines, IsForCoordinatesThatDoNotVary) {
  const auto wave = [](const Point<2>& p) { return std::sin(7 * p[0]) + 3 * p[0]; };
  Points<2> x = random_points<2>(3000, 5);
  x.row(1).setConstant(4);
  const Fit<2> result = fit<2>(sample<2>(x, wave));
  EXPECT_LE(result.report.max_error, 1e-6);
  EXPECT_NEAR((*result.components[0])(Point<2>(.5, 4)), std::sin(3.5) + 1.5, 1e-6);
}

}  // namespace
}  // namespace csrbf::fit_on_lines_test
