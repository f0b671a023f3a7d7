#include "csrbf/approx/global/axis_covariance.hpp"

#include "approx/approx_testing.hpp"

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

TEST(AxisCovariance, IsUnknownForConstantsAndFewSamples) {
  EXPECT_FALSE(estimate_axis_covariance<2>(sample<2>(random_points<2>(5, 1), franke), {}).best);
  EXPECT_FALSE(
      estimate_axis_covariance<2>(sample<2>(random_points<2>(50, 1), [](const Point<2>&) { return 3.; }), {}).best);
  EXPECT_FALSE(estimate_axis_covariance<2>(sample<2>(Points<2>::Ones(2, 9), franke), {}).best);
}

}  // namespace
}  // namespace csrbf::axis_covariance_test
