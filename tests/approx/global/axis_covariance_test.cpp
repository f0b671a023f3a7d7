#include "csrbf/approx/global/axis_covariance.hpp"

#include "approx/approx_testing.hpp"
#include "csrbf/approx/fit.hpp"

#include <numbers>

namespace csrbf::axis_covariance_test {
namespace {

TEST(AxisCovariance, HasLongLengthsOnAxesThatDoNotMatter) {
  const auto f = [](const Point<3>& p) { return std::sin(6 * p[1]); };
  const auto found = estimate_axis_covariance<3>(sample<3>(random_points<3>(150, 1), f), {}).best;
  ASSERT_TRUE(found);
  EXPECT_GE(found->lengths[0], 20 * found->lengths[1]);
  EXPECT_GE(found->lengths[2], 20 * found->lengths[1]);
  EXPECT_GE(found->kernel.smoothness(), 6);
  EXPECT_EQ(found->nugget, 0);
}

TEST(AxisCovariance, FollowsTheUnitsOfTheAxes) {
  Samples<2> data = sample<2>(random_points<2>(150, 1), franke);
  const auto first = estimate_axis_covariance<2>(data, {}).best;
  data.points.row(1) *= 1e9;
  const auto other = estimate_axis_covariance<2>(data, {}).best;
  ASSERT_TRUE(first && other);
  EXPECT_NEAR(other->lengths[1] / other->lengths[0], 1e9 * first->lengths[1] / first->lengths[0],
              .05 * other->lengths[1] / other->lengths[0]);
  const auto one = estimate_axis_covariance<2>(data, {}, true).best;
  ASSERT_TRUE(one);
  EXPECT_EQ(one->lengths[0], one->lengths[1]);
}

TEST(AxisCovariance, FindsTheNoise) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> error(0, .1);
  Samples<2> data = sample<2>(random_points<2>(400, 1), franke);
  for (double& value : data.values.reshaped()) value += error(random);
  const auto found = estimate_axis_covariance<2>(data, {}).best;
  ASSERT_TRUE(found);
  EXPECT_GE(found->nugget, .02);
  EXPECT_LE(found->nugget, .5);
}

TEST(AxisCovariance, TellsLittleNoiseFromNone) {
  constexpr double noise = .02;
  for (unsigned seed = 0; seed < 4; ++seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> error(0, noise);
    Samples<3> data = sample<3>(random_points<3>(150, seed),
                                [](const Point<3>& p) { return std::sin(7 * p[0]) * std::cos(5 * p[2]) + p[1]; });
    for (double& value : data.values.reshaped()) value += error(random);
    EXPECT_GE(csrbf::fit<3>(data).report.noise.at(0), .5 * noise) << seed;
  }
}

// At first noise explains more of few samples than a function of other lengths does.
TEST(AxisCovariance, FindsNoNoiseInFewExactSamples) {
  for (unsigned seed = 0; seed < 4; ++seed) {
    const Samples<1> data =
        sample<1>(random_points<1>(30, seed), [](const Point<1>& p) { return std::sin(18 * p[0]); });
    EXPECT_LT(csrbf::fit<1>(data).report.noise.at(0), 1e-6) << seed;
  }
}

// Both the season and the trend alone, with the season as noise, are optima of the likelihood.
TEST(AxisCovariance, FindsASeasonBesideATrend) {
  constexpr double seasons = 24, noise = .2;
  for (const unsigned seed : {1U, 2U, 3U}) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> error(0, noise);
    Samples<1> data = sample<1>(random_points<1>(150, seed), [](const Point<1>& p) {
      return std::sin(2 * std::numbers::pi * seasons * p[0]) + 1.5 * std::sin(3 * p[0]);
    });
    for (double& value : data.values.reshaped()) value += error(random);
    const auto found = estimate_axis_covariance<1>(data, {}).best;
    ASSERT_TRUE(found);
    EXPECT_LE(found->lengths[0], .1) << seed;
    EXPECT_LE(csrbf::fit<1>(data).report.noise.at(0), 2 * noise) << seed;
  }
}

// Waves as short as some spacings along one axis, seen only because they are long along the other.
TEST(AxisCovariance, FindsShortWavesAlongOneAxis) {
  constexpr double noise = .3;
  for (const unsigned seed : {1U, 2U, 3U}) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> error(0, noise);
    Samples<2> data = sample<2>(random_points<2>(300, seed),
                                [](const Point<2>& p) { return std::sin(2 * std::numbers::pi * 30 * p[0]) + p[1]; });
    for (double& value : data.values.reshaped()) value += error(random);
    EXPECT_LE(csrbf::fit<2>(data).report.noise.at(0), 2 * noise) << seed;
  }
}

TEST(AxisCovariance, DoesNotTakeKinksForNoise) {
  constexpr Index side = 14;
  Points<2> grid(2, side * side);
  for (Index i = 0; i < grid.cols(); ++i)
    grid.col(i) = Point<2>(static_cast<double>(i % side), static_cast<double>(i / side)) / (side - 1);
  for (const double phase : {0.3, 0.9, 2.6}) {
    const Samples<2> data = sample<2>(grid, [&](const Point<2>& p) {
      return std::abs(std::sin(7 * p[0] + 2 * std::sin(4 * p[1]) + phase)) + .3 * p[1];
    });
    EXPECT_LT(csrbf::fit<2>(data).report.max_error, 1e-3) << phase;
  }
}

TEST(AxisCovariance, FindsLittleNoiseOfWavesInSpace) {
  constexpr double noise = .02;
  for (const unsigned seed : {1U, 2U}) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> error(0, noise);
    Samples<3> data = sample<3>(random_points<3>(400, seed), [](const Point<3>& p) {
      return (std::sin(3 * p[0] + 6 * p[1]) + std::sin(3 * p[1] + 6 * p[2]) + std::sin(3 * p[2] + 6 * p[0])) / 1.7;
    });
    for (double& value : data.values.reshaped()) value += error(random);
    EXPECT_GE(csrbf::fit<3>(data).report.noise.at(0), noise / 2) << seed;
  }
}

// Lines of their own level, each with a slope: short lengths along them would explain what is noise.
TEST(AxisCovariance, TellsNoiseFromShortLengths) {
  constexpr Index lines = 26, each = 9;
  constexpr double noise = .5;
  for (const unsigned seed : {1U, 2U, 3U}) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    Samples<2> data{Points<2>(2, lines * each), Eigen::MatrixXd(lines * each, 1), {}};
    for (Index i = 0; i < lines; ++i) {
      const double level = 8 * normal(random);
      for (Index j = 0; j < each; ++j) {
        const double t = -1 + 2. * static_cast<double>(j) / (each - 1);
        data.points.col(i * each + j) << static_cast<double>(i), t;
        data.values(i * each + j, 0) = level + (5 + .1 * level) * t + noise * normal(random);
      }
    }
    EXPECT_NEAR(csrbf::fit<2>(data).report.noise.at(0), noise, .2 * noise) << seed;
  }
}

// Each sample is like those before and after it, and no others.
TEST(AxisCovariance, FindsWavesOfAFewSamples) {
  constexpr double correlation = .6;
  for (const unsigned seed : {1U, 2U, 3U, 4U}) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> step(0, std::sqrt(1 - correlation * correlation));
    Samples<1> data{Points<1>(1, 1500), Eigen::MatrixXd(1500, 1), {}};
    double value = 0;
    for (Index i = 0; i < data.size(); ++i) {
      value = correlation * value + step(random);
      data.points(0, i) = static_cast<double>(i);
      data.values(i, 0) = value;
    }
    const auto found = estimate_axis_covariance<1>(data, {}).best;
    ASSERT_TRUE(found);
    EXPECT_LE(left_out_error(data, *found), .65) << seed;  // by the mean .8, by the best covariance .55
  }
}

TEST(AxisCovariance, IsUnknownForConstantsAndFewSamples) {
  EXPECT_FALSE(estimate_axis_covariance<2>(sample<2>(random_points<2>(5, 1), franke), {}).best);
  EXPECT_FALSE(
      estimate_axis_covariance<2>(sample<2>(random_points<2>(50, 1), [](const Point<2>&) { return 3.; }), {}).best);
  EXPECT_FALSE(estimate_axis_covariance<2>(sample<2>(Points<2>::Ones(2, 9), franke), {}).best);
}

}  // namespace
}  // namespace csrbf::axis_covariance_test
