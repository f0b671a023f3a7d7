#include "csrbf/levelset/image/impulse_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace csrbf {
namespace {

Grid square(Index n) {
  Grid grid;
  grid.axes = 2;
  grid.size = {n, n, 1};
  return grid;
}

// A disc in a slope of light.
std::vector<float> disc_image(Index n, double noise, std::mt19937& random) {
  std::normal_distribution<double> normal;
  std::vector<float> values;
  const auto side = static_cast<double>(n);
  for (double y = 0; y < side; ++y)
    for (double x = 0; x < side; ++x) {
      const double in = std::hypot(x - 0.5 * side, y - 0.5 * side) < 0.25 * side ? 1 : 0;
      values.push_back(static_cast<float>(in + x / side + noise * normal(random)));
    }
  return values;
}

TEST(RepairImpulses, GivesThemTheMedianOfTheirNeighbours) {
  constexpr Index n = 64;
  std::mt19937 random(1);
  const std::vector<float> clean = disc_image(n, 0, random);
  std::vector<float> values = clean;
  double hit = 0;
  for (float& value : values) {
    if (random() % 10 != 0) continue;
    value = random() % 2 == 0 ? -0.5F : 2.5F;
    hit += 1;
  }
  std::vector<float> repaired;
  const std::optional<double> share = repair_impulses(values, square(n), {}, repaired);
  ASSERT_TRUE(share.has_value());
  EXPECT_NEAR(*share, hit / (n * n), 0.02);
  int off = 0;
  for (std::size_t i = 0; i < clean.size(); ++i) off += std::abs(repaired[i] - clean[i]) > 0.1F ? 1 : 0;
  EXPECT_LT(off, 0.03 * n * n);  // at the border of the disc
}

// Bars whose values impulses have, too: a median of all of their voxels would round the corners.
TEST(RepairImpulses, LeavesRegionsOfTheSameValue) {
  constexpr Index n = 64;
  std::mt19937 random(3);
  std::vector<float> clean(n * n);
  for (Index i = 0; i < n * n; ++i) clean[i] = i % n / 4 % 2 == 0 && i / n % 8 < 5 ? 1.0F : 0.0F;
  std::vector<float> values = clean;
  for (float& value : values)
    if (random() % 50 == 0) value = 1 - value;
  std::vector<float> repaired;
  ASSERT_TRUE(repair_impulses(values, square(n), {}, repaired).has_value());
  int before = 0, after = 0;
  for (std::size_t i = 0; i < clean.size(); ++i) {
    before += values[i] != clean[i] ? 1 : 0;
    after += repaired[i] != clean[i] ? 1 : 0;
  }
  EXPECT_LT(after, 0.8 * before);
}

// Most of the bright impulses lie where the image is as bright, and where nothing is dark few of the dark ones.
TEST(RepairImpulses, FindsThemBesideRegionsAsBrightOrDark) {
  constexpr Index n = 64;
  std::mt19937 random(4);
  for (const double radius : {20.0, 5.0}) {
    std::vector<float> clean(n * n);
    for (Index i = 0; i < n * n; ++i) {
      const double r = std::hypot(static_cast<double>(i % n) - 30, static_cast<double>(i / n) - 33);
      clean[i] = static_cast<float>(1 / (1 + std::exp(0.5 * (radius - r))));
    }
    const auto [dark, bright] = std::minmax_element(clean.begin(), clean.end());
    std::vector<float> values = clean;
    int before = 0, after = 0;
    for (float& value : values)
      if (random() % 12 == 0) value = random() % 2 == 0 ? *dark : *bright;
    std::vector<float> repaired;
    ASSERT_TRUE(repair_impulses(values, square(n), {}, repaired).has_value()) << radius;
    for (std::size_t i = 0; i < clean.size(); ++i) {
      before += std::abs(values[i] - clean[i]) > 0.2F ? 1 : 0;
      after += std::abs(repaired[i] - clean[i]) > 0.2F ? 1 : 0;
    }
    EXPECT_LT(after, 0.15 * before) << radius;
  }
}

TEST(RepairImpulses, FindsNoneInNoiseDrawingsAndPatterns) {
  constexpr Index n = 64;
  std::mt19937 random(2);
  std::vector<float> repaired;
  for (const double noise : {0.0, 0.1, 1.0})
    EXPECT_FALSE(repair_impulses(disc_image(n, noise, random), square(n), {}, repaired)) << noise;
  std::vector<float> grey = disc_image(n, 0.5, random), dots(n * n, 0.0F), chess(n * n);
  for (float& value : grey) value = std::round(50 * value);
  EXPECT_FALSE(repair_impulses(grey, square(n), {}, repaired));
  for (Index i = 0; i < n * n; ++i) {
    if (i % 37 == 0) dots[i] = 1;
    chess[i] = static_cast<float>((i % n + i / n) % 2);
  }
  EXPECT_FALSE(repair_impulses(dots, square(n), {}, repaired));
  EXPECT_FALSE(repair_impulses(chess, square(n), {}, repaired));
  EXPECT_TRUE(repaired.empty());
}

}  // namespace
}  // namespace csrbf
