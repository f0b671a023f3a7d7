#include "csrbf/approx/images/sparse_blocks.hpp"

#include "csrbf/core/parallel.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace csrbf::sparse_blocks_test {
namespace {

using Size = std::array<Index, 3>;

std::vector<std::uint8_t> random_mask(std::size_t voxels, double share, unsigned seed) {
  std::mt19937_64 random(seed);
  std::bernoulli_distribution draw(share);
  std::vector<std::uint8_t> mask(voxels);
  for (std::uint8_t& m : mask) m = draw(random) ? 1 : 0;
  return mask;
}

std::vector<float> random_values(std::size_t voxels, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<float> normal;
  std::vector<float> values(voxels);
  for (float& v : values) v = normal(random);
  return values;
}

TEST(SparseBlocks, RestoreAConstant) {
  const Size size{30, 20, 1};
  std::vector<float> values(600, 5.0F);
  const std::vector<std::uint8_t> unknown = random_mask(600, 0.3, 1);
  for (std::size_t i = 0; i < 600; ++i)
    if (unknown[i] != 0) values[i] = i % 2 == 0 ? 4.0F : 6.0F;
  refine_by_sparse_blocks(values, unknown, size, {.first_threshold = 8, .last_threshold = 4});
  constexpr float tolerance = 1e-3F;  // .3 to the power of the rounds and rounding
  for (const float v : values) EXPECT_NEAR(v, 5.0F, tolerance);
}

// One round, by its definition: every block by sums of cosines.
std::vector<double> one_round(const std::vector<float>& values, const std::vector<std::uint8_t>& unknown,
                              const Size& size, Index width, Index step, double threshold) {
  const auto cosine = [&](Index k, Index j) {
    const auto n = static_cast<double>(width);
    return std::sqrt((k == 0 ? 1 : 2) / n) *
           std::cos(std::numbers::pi * static_cast<double>(k) * (static_cast<double>(j) + 0.5) / n);
  };
  const auto mirrored = [&](Index i, Index n) { return i < 0 ? -i : i >= n ? 2 * n - 2 - i : i; };
  std::vector<double> sums(values.size(), 0), weights = sums;
  for (Index y0 = 1 - width; y0 < size[1]; y0 += step)
    for (Index x0 = 1 - width; x0 < size[0]; x0 += step) {
      std::vector<double> c(static_cast<std::size_t>(width * width), 0);
      double kept = 1;
      for (Index k = 0; k < width; ++k)
        for (Index l = 0; l < width; ++l) {
          double& sum = c[k * width + l];
          for (Index y = 0; y < width; ++y)
            for (Index x = 0; x < width; ++x)
              sum += cosine(k, y) * cosine(l, x) *
                     static_cast<double>(values[mirrored(y0 + y, size[1]) * size[0] + mirrored(x0 + x, size[0])]);
          const bool large = k + l == 0 || std::abs(sum) > threshold;
          if (k + l > 0 && large) kept += 1;
          if (!large) sum = 0;
        }
      for (Index y = std::max<Index>(0, y0); y < std::min(y0 + width, size[1]); ++y)
        for (Index x = std::max<Index>(0, x0); x < std::min(x0 + width, size[0]); ++x) {
          double value = 0;
          for (Index k = 0; k < width; ++k)
            for (Index l = 0; l < width; ++l) value += c[k * width + l] * cosine(k, y - y0) * cosine(l, x - x0);
          sums[y * size[0] + x] += value / kept;
          weights[y * size[0] + x] += 1 / kept;
        }
    }
  std::vector<double> result(values.begin(), values.end());
  for (std::size_t i = 0; i < result.size(); ++i)
    if (unknown[i] != 0) result[i] = sums[i] / weights[i];
  return result;
}

TEST(SparseBlocks, DoInARoundWhatTheirDefinitionSays) {
  const Size size{23, 17, 1};
  std::vector<float> values = random_values(23 * 17, 2);
  const std::vector<std::uint8_t> unknown = random_mask(values.size(), 0.2, 3);
  for (const Index width : {Index{8}, Index{6}}) {
    const std::vector<double> expected = one_round(values, unknown, size, width, 2, 1.1);
    std::vector<float> found = values;
    refine_by_sparse_blocks(found, unknown, size,
                            {.width = width, .step = 2, .first_threshold = 1.1, .last_threshold = 1.1, .rounds = 1});
    constexpr double round_off = 1e-5;
    for (std::size_t i = 0; i < found.size(); ++i)
      EXPECT_NEAR(static_cast<double>(found[i]), expected[i], round_off) << width << " " << i;
  }
}

TEST(SparseBlocks, ContinueStripesInThePlaneAndInSpace) {
  for (const Size& size : {Size{40, 30, 1}, Size{20, 18, 16}}) {
    const auto n = static_cast<std::size_t>(size[0] * size[1] * size[2]);
    std::vector<float> truth(n);
    for (std::size_t i = 0; i < n; ++i) {
      const auto x = static_cast<float>(static_cast<Index>(i) % size[0]);
      const auto y = static_cast<float>(static_cast<Index>(i) / size[0] % size[1]);
      truth[i] = std::cos(0.9F * x + 0.4F * y);
    }
    const std::vector<std::uint8_t> unknown = random_mask(n, 0.4, 4);
    std::vector<float> values = truth;
    for (std::size_t i = 0; i < n; ++i)
      if (unknown[i] != 0) values[i] = 0;
    refine_by_sparse_blocks(values, unknown, size,
                            {.step = size[2] > 1 ? 4 : 2, .first_threshold = 3, .last_threshold = 0.1, .rounds = 40});
    double before = 0, after = 0;
    for (std::size_t i = 0; i < n; ++i) {
      if (unknown[i] == 0) {
        EXPECT_EQ(values[i], truth[i]);
        continue;
      }
      before += static_cast<double>(truth[i] * truth[i]);
      after += std::pow(static_cast<double>(values[i] - truth[i]), 2);
    }
    EXPECT_LT(after, 0.05 * before);
  }
}

TEST(SparseBlocks, HaveTheSameBitsForAnyNumberOfThreads) {
  const Size size{70, 90, 1};
  const std::vector<float> start = random_values(70 * 90, 5);
  const std::vector<std::uint8_t> unknown = random_mask(start.size(), 0.5, 6);
  std::vector<std::vector<float>> results;
  for (const int threads : {1, 3}) {
    set_thread_count(threads);
    results.push_back(start);
    refine_by_sparse_blocks(results.back(), unknown, size, {.first_threshold = 3, .last_threshold = 1, .rounds = 5});
  }
  set_thread_count(0);
  EXPECT_EQ(results[0], results[1]);
}

}  // namespace
}  // namespace csrbf::sparse_blocks_test
