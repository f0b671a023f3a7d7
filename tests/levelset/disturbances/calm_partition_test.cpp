#include "csrbf/levelset/disturbances/calm_partition.hpp"

#include "levelset/segment_testing.hpp"

namespace csrbf {
namespace {

constexpr Index calm_side = 120;

double calm_discs(double x, double y) {
  return std::max({14 - std::hypot(x + 24, y - 5), 11 - std::hypot(x - 20, y + 12), 9 - std::hypot(x - 12, y - 25),
                   12 - std::hypot(x - 42, y + 40), 10 - std::hypot(x + 40, y + 35)});
}

// Noise as strong as that given, times what `factor` says of the column.
Phantom in_noise(double noise, const std::function<double(double)>& factor) {
  Phantom phantom = make_phantom(calm_side, calm_discs, 1, 0);
  std::mt19937 random(9);
  std::normal_distribution<double> normal(0, noise);
  for (Index i = 0; i < calm_side * calm_side; ++i)
    phantom.image.values[i] += static_cast<float>(factor(static_cast<double>(i % calm_side)) * normal(random));
  return phantom;
}

TEST(CalmPartition, FollowsNoiseThatVariesOverThePlace) {
  const Phantom grows = in_noise(180, [](double x) { return 0.05 + 0.95 * x * x / (calm_side * calm_side); });
  const Phantom steps = in_noise(120, [](double x) { return x < 70 ? 0.1 : 1; });
  for (const Phantom* each : {&grows, &steps}) {
    const Segmentation<2> found = segment<2>(each->image);
    EXPECT_GT(dice(found.labels, each->truth), 0.93);
    EXPECT_GT(found.report.uneven_noise.value_or(0), 2);
  }
  EXPECT_FALSE(segment<2>(in_noise(30, [](double) { return 1; }).image).report.uneven_noise);
}

// Noise of the regions themselves says nothing about places.
TEST(CalmPartition, LeavesDeviationsToRegions) {
  Phantom phantom = make_phantom(
      calm_side, [](double x, double y) { return 35 - std::hypot(x, y); }, 1, 0);
  std::mt19937 random(9);
  std::normal_distribution<double> normal(0, 1);
  for (std::size_t i = 0; i < phantom.truth.size(); ++i)
    phantom.image.values[i] = static_cast<float>(100 + (phantom.truth[i] != 0 ? 30 : 5) * normal(random));
  const Segmentation<2> found = segment<2>(phantom.image);
  EXPECT_GT(dice(found.labels, phantom.truth), 0.95);
  EXPECT_FALSE(found.report.uneven_noise);
}

}  // namespace
}  // namespace csrbf
