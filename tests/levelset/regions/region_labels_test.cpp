#include "csrbf/levelset/regions/region_labels.hpp"

#include <gtest/gtest.h>

#include <queue>
#include <random>

namespace csrbf::region_labels_test {
namespace {

Grid grid_of(Index nx, Index ny, Index nz) {
  Grid grid;
  grid.size = {nx, ny, nz};
  return grid;
}

std::vector<std::uint8_t> random_labels(Index voxels, int labels, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_int_distribution<int> uniform(0, labels - 1);
  std::vector<std::uint8_t> values(voxels);
  for (std::uint8_t& value : values) value = static_cast<std::uint8_t>(uniform(generator));
  return values;
}

// Voxels of each part, by flooding.
std::vector<std::vector<Index>> parts_of(const std::vector<std::uint8_t>& labels, const Grid& grid) {
  std::vector<std::vector<Index>> parts;
  std::vector<bool> seen(labels.size(), false);
  for (Index start = 0; start < grid.voxels(); ++start) {
    if (seen[start]) continue;
    parts.emplace_back();
    std::queue<Index> queue({start});
    seen[start] = true;
    while (!queue.empty()) {
      const Index i = queue.front();
      queue.pop();
      parts.back().push_back(i);
      const std::array<Index, 3> at{i % grid.size[0], i / grid.size[0] % grid.size[1], i / grid.size[0] / grid.size[1]};
      const std::array<Index, 3> strides{1, grid.size[0], grid.size[0] * grid.size[1]};
      for (std::size_t a = 0; a < 3; ++a)
        for (const Index side : {-1, 1}) {
          if (at[a] + side < 0 || at[a] + side >= grid.size[a]) continue;
          const auto j = static_cast<std::size_t>(i + side * strides[a]);
          if (seen[j] || labels[j] != labels[i]) continue;
          seen[j] = true;
          queue.push(static_cast<Index>(j));
        }
    }
  }
  return parts;
}

bool at_border(const Grid& grid, Index i) {
  const std::array<Index, 3> at{i % grid.size[0], i / grid.size[0] % grid.size[1], i / grid.size[0] / grid.size[1]};
  bool border = false;
  for (std::size_t a = 0; a < 3; ++a)
    border = border || (grid.size[a] > 1 && (at[a] == 0 || at[a] == grid.size[a] - 1));
  return border;
}

TEST(CountComponents, AgreesWithFlooding) {
  for (const Grid& grid : {grid_of(17, 13, 1), grid_of(9, 8, 7), grid_of(30, 1, 1)})
    for (unsigned seed = 1; seed <= 5; ++seed)
      for (const int labels : {2, 4}) {
        const auto values = random_labels(grid.voxels(), labels, seed);
        Index expected = 0;
        for (const auto& part : parts_of(values, grid)) expected += values[part[0]] != 0 ? 1 : 0;
        EXPECT_EQ(count_components(values, grid), expected);
      }
}

TEST(FillEnclosed, FillsWhatDoesNotReachTheBorder) {
  Index all_filled = 0, stay = 0;
  for (const Grid& grid : {grid_of(17, 13, 1), grid_of(9, 8, 7)})
    for (unsigned seed = 1; seed <= 5; ++seed) {
      const auto values = random_labels(grid.voxels(), 2, seed), marks = random_labels(grid.voxels(), 20, seed + 5);
      std::vector<std::uint8_t> expected = values, expected_with_seeds = values;
      Index filled = 0;
      for (const auto& part : parts_of(values, grid)) {
        bool open = values[part[0]] != 0;
        for (const Index i : part) open = open || at_border(grid, i);
        if (open) continue;
        filled += static_cast<Index>(part.size());
        for (const Index i : part) expected[i] = 1;
        const bool marked = std::any_of(part.begin(), part.end(), [&](Index i) { return marks[i] == 1; });
        for (const Index i : part) expected_with_seeds[i] = marked ? 0 : 1;
        stay += marked ? 1 : 0;
      }
      std::vector<std::uint8_t> result = values;
      EXPECT_EQ(fill_enclosed(result, grid), filled);
      EXPECT_EQ(result, expected);
      result = values;
      fill_enclosed(result, grid, marks);
      EXPECT_EQ(result, expected_with_seeds);
      all_filled += filled;
    }
  EXPECT_GT(all_filled, 0);
  EXPECT_GT(stay, 0);
}

TEST(SeededRegion, IsTheOneThatTheSeedCoversMoreOf) {
  const std::vector<std::uint8_t> labels{0, 0, 0, 0, 0, 0, 1, 1, 1, 1};
  EXPECT_EQ(seeded_region(labels, std::vector<std::uint8_t>{0, 0, 0, 0, 0, 0, 1, 0, 0, 0}, {}), 1);
  EXPECT_EQ(seeded_region(labels, std::vector<std::uint8_t>{1, 0, 0, 0, 0, 0, 0, 0, 0, 0}, {}), 0);
  // Three of six against three of four: more voxels outside, more of the inside.
  EXPECT_EQ(seeded_region(labels, std::vector<std::uint8_t>{1, 1, 1, 0, 0, 0, 1, 1, 1, 0}, {}), 1);
  EXPECT_EQ(seeded_region(labels, std::vector<std::uint8_t>{1, 1, 1, 0, 0, 0, 1, 1, 0, 0}, {}), -1);
  const std::vector<std::uint8_t> mask{1, 1, 1, 1, 1, 1, 0, 0, 0, 1};
  EXPECT_EQ(seeded_region(labels, std::vector<std::uint8_t>{1, 0, 0, 0, 0, 0, 1, 1, 1, 0}, mask), 0);
}

TEST(BorderRegion, CountsEachVoxelOfTheBorderOnce) {
  for (const Grid& grid : {grid_of(17, 13, 1), grid_of(9, 8, 7)})
    for (unsigned seed = 1; seed <= 5; ++seed) {
      const auto values = random_labels(grid.voxels(), 3, seed), mask = random_labels(grid.voxels(), 2, seed + 9);
      std::array<Index, 3> counts{0, 0, 0};
      for (Index i = 0; i < grid.voxels(); ++i)
        if (at_border(grid, i) && mask[i] != 0) ++counts[values[i]];
      EXPECT_EQ(border_region(values, grid, mask, 3), std::max_element(counts.begin(), counts.end()) - counts.begin());
    }
}

TEST(MeasureRegions, GivesVolumesMeansAndDeviations) {
  Grid grid = grid_of(3, 2, 1);
  grid.spacing = Point<3>(0.5, 2, 7);
  const std::vector<std::uint8_t> labels{0, 1, 1, 0, 1, 1}, mask{1, 1, 1, 1, 1, 0};
  const std::vector<float> values{5, 1, 2, 7, 3, 100};
  const std::vector<RegionReport> regions = measure_regions(labels, values, grid, mask, 2);
  ASSERT_EQ(regions.size(), 2U);
  EXPECT_EQ(regions[1].voxels, 3);
  EXPECT_DOUBLE_EQ(regions[1].volume, 3);  // pixels of 0.5 x 2: the third axis has no extent
  EXPECT_DOUBLE_EQ(regions[1].mean, 2);
  EXPECT_DOUBLE_EQ(regions[1].sd, std::sqrt(2.0 / 3));
  EXPECT_DOUBLE_EQ(regions[0].mean, 6);
  EXPECT_DOUBLE_EQ(regions[0].sd, 1);
}

}  // namespace
}  // namespace csrbf::region_labels_test
