#include "csrbf/levelset/disturbances/calm_partition.hpp"

#include "csrbf/levelset/disturbances/fringes.hpp"
#include "levelset/segment_testing.hpp"

namespace csrbf {
namespace {

constexpr Index calm_side = 120;

double calm_discs(double x, double y) {
  return std::max({14 - std::hypot(x + 24, y - 5), 11 - std::hypot(x - 20, y + 12), 9 - std::hypot(x - 12, y - 25),
                   12 - std::hypot(x - 42, y + 40), 10 - std::hypot(x + 40, y + 35)});
}

// Adds to each voxel what `wave` says (coordinates from the corner).
Phantom with_waves(const std::function<double(double, double)>& wave) {
  Phantom phantom = make_phantom(calm_side, calm_discs, 1, 15);
  for (Index i = 0; i < calm_side * calm_side; ++i)
    phantom.image.values[i] +=
        static_cast<float>(wave(static_cast<double>(i % calm_side), static_cast<double>(i / calm_side)));
  return phantom;
}

TEST(CalmPartition, LeavesOutFringes) {
  const Phantom tilted = with_waves([](double x, double y) { return 80 * std::sin(0.52 * x + 0.31 * y); });
  const Segmentation<2> found = segment<2>(tilted.image);
  EXPECT_GT(dice(found.labels, tilted.truth), 0.97);
  EXPECT_EQ(found.report.fringes.value_or(0), 1);
  const Phantom rows = with_waves([](double, double y) { return std::fmod(y, 2) < 1 ? 90 : 0; });
  EXPECT_GT(dice(segment<2>(rows.image).labels, rows.truth), 0.97);
}

TEST(CalmPartition, LeavesOutAMesh) {
  const Phantom mesh = with_waves([](double x, double y) {
    const double u = x + 0.07 * y, v = y - 0.07 * x;
    return std::min(std::abs(std::remainder(u, 20.0)), std::abs(std::remainder(v, 20.0))) < 1.5 ? -150 : 0;
  });
  const Segmentation<2> found = segment<2>(mesh.image);
  EXPECT_GT(dice(found.labels, mesh.truth), 0.9);
  EXPECT_GT(found.report.fringes.value_or(0), 4);
}

TEST(CalmPartition, KeepsBarsAndNoise) {
  const Phantom bars = make_phantom(
      calm_side, [](double x, double y) { return std::min(3 - std::abs(std::remainder(x, 12.0)), 40 - std::abs(y)); },
      1, 20);
  EXPECT_GT(dice(segment<2>(bars.image).labels, bars.truth), 0.95);
  const Phantom plain = make_phantom(calm_side, calm_discs, 1, 30);
  EXPECT_FALSE(find_fringes(plain.image.values, plain.image.grid, {}));
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
