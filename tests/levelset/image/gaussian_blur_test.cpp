#include "csrbf/levelset/image/gaussian_blur.hpp"

#include "core/error_testing.hpp"
#include "csrbf/core/parallel.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace csrbf::gaussian_blur_test {
namespace {

constexpr double rounding = 1e-6;  // of values up to 1

std::vector<float> random_values(std::size_t n, unsigned seed) {
  std::mt19937 generator(seed);
  std::vector<float> values(n);
  for (float& value : values) value = std::uniform_real_distribution<float>(0, 1)(generator);
  return values;
}

TEST(GaussianBlur, SpreadsAVoxelAsAGaussian) {
  constexpr Index n = 41;
  std::vector<float> values(n * n, 0.0F);
  values[20 + n * 20] = 1;
  gaussian_blur(values, {n, n, 1}, {1.5, 2.5, 0});
  double sum = 0, xx = 0, yy = 0;
  for (Index i = 0; i < n * n; ++i) {
    const auto value = static_cast<double>(values[i]);
    const auto x = static_cast<double>(i % n - 20), y = static_cast<double>(i / n - 20);
    sum += value;
    xx += value * x * x;
    yy += value * y * y;
  }
  EXPECT_NEAR(sum, 1, rounding);
  EXPECT_NEAR(xx, 1.5 * 1.5, 0.01);  // what is cut off at 4 deviations
  EXPECT_NEAR(yy, 2.5 * 2.5, 0.01);
}

TEST(GaussianBlur, IsSymmetricAndKeepsConstants) {
  for (const std::array<Index, 3>& size : {std::array<Index, 3>{23, 17, 9}, {2, 50, 1}, {70, 1, 3}}) {
    const auto n = static_cast<std::size_t>(size[0] * size[1] * size[2]);
    const std::array<double, 3> sd{1.2, 3, 0.8};
    const std::vector<float> a = random_values(n, 1), b = random_values(n, 2);
    std::vector<float> Ga = a, Gb = b, ones(n, 1.0F);
    gaussian_blur(Ga, size, sd);
    gaussian_blur(Gb, size, sd);
    gaussian_blur(ones, size, sd);
    double left = 0, right = 0;
    for (std::size_t i = 0; i < n; ++i) {
      left += static_cast<double>(a[i] * Gb[i]);
      right += static_cast<double>(b[i] * Ga[i]);
      ASSERT_NEAR(ones[i], 1, rounding);
    }
    EXPECT_NEAR(left, right, rounding * static_cast<double>(n));
  }
}

TEST(GaussianBlur, GivesTheSameBitsForEveryThreadCount) {
  const std::vector<float> values = random_values(200 * 90 * 40, 3);
  std::vector<float> one = values, two = values;
  set_thread_count(1);
  gaussian_blur(one, {200, 90, 40}, {1, 2, 3});
  set_thread_count(2);
  gaussian_blur(two, {200, 90, 40}, {1, 2, 3});
  set_thread_count(0);
  EXPECT_EQ(one, two);
}

TEST(GaussianBlur, SaysWhatIsWrong) {
  std::vector<float> values(6);
  EXPECT_EQ(invalid_input_message([&] {
              gaussian_blur(values, {2, 2, 1}, {1, 1, 1});
            }),
            "gaussian_blur: values.size() = 6: must be the product of the sizes along the axes");
  EXPECT_EQ(invalid_input_message([&] {
              gaussian_blur(values, {3, 2, 1}, {1, -1, 1});
            }),
            "gaussian_blur: sd = -1: must not be negative");
}

}  // namespace
}  // namespace csrbf::gaussian_blur_test
