#include "csrbf/levelset/image/noise_grain.hpp"

#include "csrbf/levelset/image/gaussian_blur.hpp"

#include <gtest/gtest.h>

#include <random>

namespace csrbf::noise_grain_test {
namespace {

constexpr Index n = 160;

Grid square() {
  Grid grid;
  grid.axes = 2;
  grid.size = {n, n, 1};
  return grid;
}

std::vector<float> noise(const std::array<double, 3>& blur) {
  std::mt19937 generator(3);
  std::normal_distribution<float> normal(0, 1);
  std::vector<float> values(static_cast<std::size_t>(n * n));
  for (float& x : values) x = normal(generator);
  gaussian_blur(values, {n, n, 1}, blur);
  return values;
}

TEST(NoiseGrain, IsWhatABlurOfTheNoiseCovers) {
  EXPECT_EQ(noise_grain(noise({0, 0, 0}), square(), {}), 1);
  const double along = std::sqrt(4 * M_PI);
  EXPECT_NEAR(noise_grain(noise({1.5, 1.5, 0}), square(), {}), 2.25 * along * along, 3);
  EXPECT_NEAR(noise_grain(noise({2, 0, 0}), square(), {}), 2 * along, 0.7);
}

TEST(NoiseGrain, IsNotThatOfStructures) {
  std::vector<float> values = noise({0, 0, 0});
  for (Index i = 0; i < n * n; ++i) values[i] += 0.05F * static_cast<float>(i % n);  // a ramp
  EXPECT_EQ(noise_grain(values, square(), {}), 1);
}

TEST(NoiseGrain, LeavesOutWhatTheMaskLeavesOut) {
  std::vector<float> values = noise({1.5, 1.5, 0});
  std::vector<std::uint8_t> mask(values.size(), 1);
  const double whole = noise_grain(values, square(), mask);
  EXPECT_EQ(whole, noise_grain(values, square(), {}));
  for (Index i = 0; i < n * n / 2; ++i) {
    values[i] = 1000;
    mask[i] = 0;
  }
  EXPECT_NEAR(noise_grain(values, square(), mask), whole, 0.2 * whole);
}

}  // namespace
}  // namespace csrbf::noise_grain_test
