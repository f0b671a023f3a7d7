#include "csrbf/levelset/image/smooth_mean.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace csrbf::smooth_mean_test {
namespace {

std::vector<float> cubic_light() {
  std::vector<float> values;
  for (int y = 0; y < 80; ++y)
    for (int x = 0; x < 80; ++x) {
      const double u = x / 39.5 - 1, v = y / 39.5 - 1;
      values.push_back(static_cast<float>(u * u * u - .6 * u + v * v * u));
    }
  return values;
}

// Of noise one round is enough, of light without noise all pay.
TEST(SmoothMean, CostsWhatItFollows) {
  const Grid grid{.size = {80, 80, 1}};
  std::vector<float> light = cubic_light(), noise(light.size());
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  for (float& value : noise) value = normal(random);
  const std::vector<float> weights(noise.size(), 1);
  const double of_noise = smooth_mean(weights, noise, grid), of_light = smooth_mean(weights, light, grid);
  EXPECT_LT(of_noise, 8);
  EXPECT_GT(of_light, 1.5 * of_noise);
  double mean_squares = 0;
  for (const float mean : noise) mean_squares += std::pow(static_cast<double>(mean), 2) / 6400;
  EXPECT_LT(mean_squares, .005);
}

TEST(SmoothMean, FollowsCubicLight) {
  const Grid grid{.size = {80, 80, 1}};
  std::vector<float> values = cubic_light();
  const std::vector<float> weights(values.size(), 1), light = values;
  smooth_mean(weights, values, grid);
  double left = 0, all = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    left += std::pow(static_cast<double>(values[i] - light[i]), 2);
    all += std::pow(static_cast<double>(light[i]), 2);
  }
  EXPECT_LE(left, .02 * all);
}

}  // namespace
}  // namespace csrbf::smooth_mean_test
