#include "csrbf/levelset/image/smooth_mean.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace csrbf::smooth_mean_test {
namespace {

// Of so many independent numbers a mean of noise has the variance.
TEST(SmoothMean, CountsItsIndependentNumbers) {
  for (const std::array<Index, 3> size : {std::array<Index, 3>{96, 96, 1}, {120, 30, 1}, {32, 32, 32}}) {
    const Grid grid{.size = size};
    const std::size_t n = static_cast<std::size_t>(size[0] * size[1] * size[2]);
    const std::vector<float> weights(n, 1);
    double numbers = 0, trace = 0;
    constexpr int asked = 40;
    for (int k = 0; k < asked; ++k) {  // what a value alone keeps of itself, at some places
      std::vector<float> values(n, 0);
      const std::size_t place =
          (static_cast<std::size_t>(k) * 2 + 1) * n / (2 * asked) + static_cast<std::size_t>(k) * 7 % 29;
      values[place % n] = 1;
      numbers = smooth_mean(weights, values, grid);
      trace += static_cast<double>(values[place % n]) * static_cast<double>(n) / asked;
    }
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
  EXPECT_LE(left, .01 * all);
}

}  // namespace
}  // namespace csrbf::smooth_mean_test
