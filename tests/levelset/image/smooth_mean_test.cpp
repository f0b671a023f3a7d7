#include "csrbf/levelset/image/smooth_mean.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace csrbf::smooth_mean_test {
namespace {

// They are the trace of what takes values to their mean: what each keeps of itself, here at some places.
TEST(SmoothMean, CountsItsIndependentNumbers) {
  for (const std::array<Index, 3>& size : {std::array<Index, 3>{96, 96, 1}, {120, 30, 1}, {32, 32, 32}}) {
    const Grid grid{.size = size};
    const auto n = static_cast<std::size_t>(size[0] * size[1] * size[2]);
    const std::vector<float> weights(n, 1);
    std::mt19937 random(1);
    std::uniform_int_distribution<std::size_t> places(0, n - 1);
    double numbers = 0, kept = 0;
    constexpr int asked = 60;
    for (int k = 0; k < asked; ++k) {
      const std::size_t place = places(random);
      std::vector<float> values(n, 0);
      values[place] = 1;
      numbers = smooth_mean(weights, values, grid);
      kept += static_cast<double>(values[place]) / asked;
    }
    const double trace = kept * static_cast<double>(n);
    EXPECT_NEAR(numbers, trace, .3 * trace) << size[0];
  }
}

TEST(SmoothMean, FollowsCubicLight) {
  const Grid grid{.size = {80, 80, 1}};
  std::vector<float> values;
  for (int y = 0; y < 80; ++y)
    for (int x = 0; x < 80; ++x) {
      const double u = x / 39.5 - 1, v = y / 39.5 - 1;
      values.push_back(static_cast<float>(u * u * u - .6 * u + v * v * u));
    }
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
