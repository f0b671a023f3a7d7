#include "csrbf/levelset/image/box_mean.hpp"

#include "core/error_testing.hpp"
#include "csrbf/core/parallel.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace csrbf::box_mean_test {
namespace {

using Size = std::array<Index, 3>;

// Three roundings to float, one per axis, of values below 10.
constexpr double rounding = 10 * 3 * 6e-8;

std::vector<float> random_values(const Size& size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(-10, 10);
  std::vector<float> values(size[0] * size[1] * size[2]);
  for (float& value : values) value = uniform(random);
  return values;
}

double mean_around(const std::vector<float>& values, const Size& size, const Size& w, Index x, Index y, Index z) {
  double sum = 0;
  Index n = 0;
  for (Index k = std::max<Index>(0, z - w[2]); k <= std::min(size[2] - 1, z + w[2]); ++k)
    for (Index j = std::max<Index>(0, y - w[1]); j <= std::min(size[1] - 1, y + w[1]); ++j)
      for (Index i = std::max<Index>(0, x - w[0]); i <= std::min(size[0] - 1, x + w[0]); ++i, ++n)
        sum += static_cast<double>(values[i + size[0] * (j + size[1] * k)]);
  return sum / static_cast<double>(n);
}

TEST(BoxMean, OfOneVoxelSpreadsItOverTheBox) {
  std::vector<float> values(7, 0.0f);
  values[3] = 5;
  box_mean(values, {7, 1, 1}, {2, 2, 2});
  EXPECT_EQ(values, (std::vector<float>{0, 1.25f, 1, 1, 1, 1.25f, 0}));
}

TEST(BoxMean, IsTheMeanOfTheBox) {
  for (const Size& size : {Size{37, 1, 1}, Size{40, 33, 1}, Size{33, 7, 35}, Size{1, 70, 2}, Size{3, 1, 9}}) {
    for (const Size& w : {Size{1, 1, 1}, Size{3, 0, 2}, Size{2, 5, 100}}) {
      const std::vector<float> values = random_values(size, 1);
      std::vector<float> means = values;
      box_mean(means, size, w);
      std::size_t i = 0;
      for (Index z = 0; z < size[2]; ++z)
        for (Index y = 0; y < size[1]; ++y)
          for (Index x = 0; x < size[0]; ++x, ++i)
            EXPECT_NEAR(static_cast<double>(means[i]), mean_around(values, size, w, x, y, z), rounding)
                << x << " " << y << " " << z;
    }
  }
}

TEST(BoxMean, OfWidthZeroChangesNothing) {
  const Size size = {9, 8, 7};
  const std::vector<float> values = random_values(size, 2);
  std::vector<float> means = values;
  box_mean(means, size, {0, 0, 0});
  EXPECT_EQ(means, values);
}

TEST(BoxMean, DoesNotDriftAlongALongLine) {
  const Size size = {1000000, 1, 1};
  std::vector<float> values = random_values(size, 3);
  values[10] = 1e6f;  // with sums of single precision its rounding would stay
  const std::vector<float> before = values;
  box_mean(values, size, {2, 0, 0});
  for (Index x = size[0] - 100; x < size[0]; ++x)
    EXPECT_NEAR(static_cast<double>(values[x]), mean_around(before, size, {2, 0, 0}, x, 0, 0), rounding);
}

TEST(BoxMean, DoesNotDependOnTheNumberOfThreads) {
  const Size size = {61, 50, 43};
  const auto means = [&](int threads) {
    set_thread_count(threads);
    std::vector<float> values = random_values(size, 4);
    box_mean(values, size, {3, 3, 3});
    set_thread_count(0);
    return values;
  };
  EXPECT_EQ(means(1), means(3));
}

TEST(BoxMean, RejectsWhatDoesNotFit) {
  std::vector<float> values(6);
  EXPECT_EQ(invalid_input_message([&] {
              box_mean(values, {2, 2, 1}, {1, 1, 1});
            }),
            "box_mean: values.size() = 6: must be the product of the sizes along the axes");
  EXPECT_EQ(invalid_input_message([&] {
              box_mean(values, {2, 3, 1}, {1, -1, 1});
            }),
            "box_mean: half_width = -1: must not be negative");
}

}  // namespace
}  // namespace csrbf::box_mean_test
