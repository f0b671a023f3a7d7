#include "csrbf/levelset/regions/region_cores.hpp"

#include "core/error_testing.hpp"
#include "csrbf/core/parallel.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace csrbf::region_cores_test {
namespace {

using Size = std::array<Index, 3>;
using Labels = std::vector<std::uint8_t>;

// Balls of labels 0 to 2, some of them large, and voxels of no region.
Labels random_labels(const Size& size, unsigned seed) {
  std::mt19937 random(seed);
  Labels labels(static_cast<std::size_t>(size[0] * size[1] * size[2]), 0);
  for (int ball = 0; ball < 12; ++ball) {
    Size center{};
    for (std::size_t a = 0; a < 3; ++a) center[a] = static_cast<Index>(random() % static_cast<unsigned>(size[a]));
    const auto radius = static_cast<Index>(2 + random() % 9);
    const auto label = static_cast<std::uint8_t>(ball == 5 ? no_region : random() % 3);
    std::size_t i = 0;
    for (Index z = 0; z < size[2]; ++z)
      for (Index y = 0; y < size[1]; ++y)
        for (Index x = 0; x < size[0]; ++x, ++i) {
          const Index d[] = {x - center[0], y - center[1], z - center[2]};
          if (d[0] * d[0] + d[1] * d[1] + d[2] * d[2] <= radius * radius) labels[i] = label;
        }
  }
  return labels;
}

bool has_other_label_around(const Labels& labels, const Size& size, const Size& w, Index x, Index y, Index z) {
  const auto at = [&](Index i, Index j, Index k) { return labels[i + size[0] * (j + size[1] * k)]; };
  for (Index k = std::max<Index>(0, z - w[2]); k <= std::min(size[2] - 1, z + w[2]); ++k)
    for (Index j = std::max<Index>(0, y - w[1]); j <= std::min(size[1] - 1, y + w[1]); ++j)
      for (Index i = std::max<Index>(0, x - w[0]); i <= std::min(size[0] - 1, x + w[0]); ++i)
        if (at(i, j, k) != at(x, y, z)) return true;
  return false;
}

TEST(RegionCores, EndAtADistanceFromTheBorder) {
  const Labels labels = {1, 1, 1, 1, 1, 0, 0, 0, 0, 0};
  constexpr std::uint8_t none = no_region;
  EXPECT_EQ(region_cores(labels, {10, 1, 1}, {2, 2, 2}), (Labels{1, 1, 1, none, none, none, none, 0, 0, 0}));
  EXPECT_EQ(region_cores(labels, {1, 10, 1}, {2, 1, 2}), (Labels{1, 1, 1, 1, none, none, 0, 0, 0, 0}));
  EXPECT_EQ(region_cores(labels, {1, 1, 10}, {2, 2, 0}), labels);
  EXPECT_EQ(region_cores(labels, {10, 1, 1}, {std::numeric_limits<Index>::max(), 0, 0}), labels);  // no core
}

TEST(RegionCores, AreTheVoxelsWhoseBoxHasOneLabel) {
  for (const Size& size : {Size{70, 66, 1}, Size{30, 21, 25}, Size{1, 90, 40}}) {
    for (const Size& w : {Size{1, 1, 1}, Size{2, 0, 1}}) {
      const Labels labels = random_labels(size, 1);
      const Labels cores = region_cores(labels, size, w);
      std::array<Index, 256> all{};
      std::array<Index, 256> kept{};
      Labels expected = labels;
      std::size_t i = 0;
      for (Index z = 0; z < size[2]; ++z)
        for (Index y = 0; y < size[1]; ++y)
          for (Index x = 0; x < size[0]; ++x, ++i) {
            ++all[labels[i]];
            if (has_other_label_around(labels, size, w, x, y, z)) {
              expected[i] = no_region;
            } else {
              ++kept[labels[i]];
            }
          }
      for (std::size_t k = 0; k < 3; ++k) ASSERT_GE(10 * kept[k], all[k]);
      EXPECT_EQ(cores, expected);
    }
  }
}

TEST(RegionCores, OfThinRegionsAreTheseRegions) {
  const Size size = {40, 40, 1};
  Labels labels(1600, 0);
  for (std::size_t x = 0; x < 40; ++x) labels[20 * 40 + x] = 1;
  const Labels cores = region_cores(labels, size, {1, 1, 1});
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const std::size_t y = i / 40;
    EXPECT_EQ(cores[i], y == 20 ? 1 : y == 19 || y == 21 ? no_region : 0);
  }
}

TEST(RegionCores, DoNotDependOnTheNumberOfThreads) {
  const Size size = {90, 80, 70};
  const Labels labels = random_labels(size, 2);
  const auto cores = [&](int threads) {
    set_thread_count(threads);
    Labels result = region_cores(labels, size, {2, 2, 2});
    set_thread_count(0);
    return result;
  };
  EXPECT_EQ(cores(1), cores(3));
}

TEST(RegionCores, RejectWhatDoesNotFit) {
  const Labels labels(6);
  EXPECT_EQ(invalid_input_message([&] {
              region_cores(labels, {2, 2, 1}, {1, 1, 1});
            }),
            "region_cores: labels.size() = 6: must be the product of the sizes along the axes");
  EXPECT_EQ(invalid_input_message([&] {
              region_cores(labels, {2, 3, 1}, {1, 1, -1});
            }),
            "region_cores: half_width = -1: must not be negative");
}

}  // namespace
}  // namespace csrbf::region_cores_test
