#include "csrbf/levelset/seeded/divide_by_seeds.hpp"

#include "csrbf/levelset/segment.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace csrbf::divide_by_seeds_test {
namespace {

constexpr Index side = 24, length = 36;

Volume<float> box() {
  VolumeLayout layout;
  layout.grid.size = {length, side, side};
  return Volume<float>(layout);
}

// Two balls that overlap a little, along x: 1 and 2, and what is around them.
std::vector<std::uint8_t> two_balls() {
  std::vector<std::uint8_t> labels;
  for (double z = 0; z < side; ++z)
    for (double y = 0; y < side; ++y)
      for (double x = 0; x < length; ++x) {
        const double off = std::pow(y - 11.5, 2) + std::pow(z - 11.5, 2);
        const bool first = off + std::pow(x - 11, 2) < 64, second = off + std::pow(x - 24, 2) < 49;
        labels.push_back(first && x < 18 ? 1 : second ? 2 : 0);
      }
  return labels;
}

Volume<float> image_of(const std::vector<std::uint8_t>& labels, const std::array<double, 3>& levels, double noise) {
  Volume<float> image = box();
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0, 1);
  for (std::size_t i = 0; i < labels.size(); ++i)
    image.values[i] = static_cast<float>(levels[labels[i]] + noise * normal(random));
  return image;
}

void mark(std::vector<std::uint8_t>& seeds, Index x, Index y, Index z, Index half, std::uint8_t number) {
  const Grid grid = box().grid;
  for (Index w = z - half; w <= z + half; ++w)
    for (Index v = y - half; v <= y + half; ++v)
      for (Index u = x - half; u <= x + half; ++u) seeds[grid.index(u, v, w)] = number;
}

double dice(const std::vector<std::uint8_t>& labels, const std::vector<std::uint8_t>& truth, int label) {
  double both = 0, sum = 0;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    both += labels[i] == label && truth[i] == label ? 1 : 0;
    sum += (labels[i] == label ? 1 : 0) + (truth[i] == label ? 1 : 0);
  }
  return 2 * both / sum;
}

SegmentOptions with_seeds(Index first_half) {
  SegmentOptions options;
  options.regions = 3;
  options.seeds.assign(box().values.size(), 0);
  mark(options.seeds, 3, 3, 3, 1, 1);
  mark(options.seeds, 10, 12, 10, first_half, 2);
  mark(options.seeds, 25, 11, 12, 1, 3);
  return options;
}

// The shortest contour runs around the seeds of one ball.
TEST(DivideBySeeds, DividesOrgansOfOneIntensityAtTheirNeck) {
  const std::vector<std::uint8_t> truth = two_balls();
  const Volume<float> image = image_of(truth, {40, 100, 100}, 6);
  for (const Index half : {0, 3}) {
    const Segmentation<3> found = segment<3>(image, with_seeds(half));
    EXPECT_GT(dice(found.labels, truth, 1), 0.97) << half;
    EXPECT_GT(dice(found.labels, truth, 2), 0.97) << half;
    ASSERT_EQ(found.report.warnings.size(), 1U) << half;
    EXPECT_NE(found.report.warnings[0].find("labels 1 and 2"), std::string::npos) << found.report.warnings[0];
  }
}

// The background has seeds in a ball like the one that is wanted.
TEST(DivideBySeeds, KeepsWhatIsLikeAnOrganOutOfIt) {
  std::vector<std::uint8_t> truth = two_balls();
  const Volume<float> image = image_of(truth, {40, 100, 100}, 6);
  for (std::uint8_t& label : truth) label = label == 1 ? 1 : 0;
  SegmentOptions options = with_seeds(1);
  options.regions = 2;
  for (std::uint8_t& seed : options.seeds) seed = seed == 3 ? 1 : seed;
  const Segmentation<3> found = segment<3>(image, options);
  EXPECT_GT(dice(found.labels, truth, 1), 0.97);
  EXPECT_EQ(found.report.warnings.size(), 1U);
}

TEST(DivideBySeeds, LeavesAloneWhatIntensitiesTellApart) {
  const std::vector<std::uint8_t> truth = two_balls();
  for (const double noise : {0.0, 15.0}) {
    const Segmentation<3> found = segment<3>(image_of(truth, {40, 100, 70}, noise), with_seeds(1));
    EXPECT_GT(dice(found.labels, truth, 1), 0.97) << noise;
    EXPECT_GT(dice(found.labels, truth, 2), 0.95) << noise;
    EXPECT_TRUE(found.report.warnings.empty()) << noise;
  }
}

// Without a neck a few seeds do not say how much of a ball is whose.
TEST(DivideBySeeds, SaysWhereSeedsAreTooFew) {
  std::vector<std::uint8_t> ball = two_balls();
  for (std::uint8_t& label : ball) label = label == 1 ? 1 : 0;
  SegmentOptions options = with_seeds(1);
  for (std::uint8_t& seed : options.seeds) seed = seed == 3 ? 0 : seed;
  mark(options.seeds, 13, 9, 13, 1, 3);
  const Segmentation<3> found = segment<3>(image_of(ball, {40, 100, 100}, 6), options);
  ASSERT_EQ(found.report.warnings.size(), 1U);
  EXPECT_NE(found.report.warnings[0].find("labels 1 and 2"), std::string::npos) << found.report.warnings[0];
  EXPECT_NE(found.report.warnings[0].find("mark more of both"), std::string::npos) << found.report.warnings[0];
}

// Borders are midway on a bar, whatever its voxels, and follow seeds, not labels without any.
TEST(DivideBySeeds, MeasuresAlongPathsWithinBothParts) {
  Grid grid;
  grid.size = {40, 9, 9};
  grid.spacing = {1, 2, 2};
  const auto voxels = static_cast<std::size_t>(grid.voxels());
  std::vector<std::uint8_t> labels(voxels, 1), seeds(voxels, 0);
  seeds[grid.index(5, 4, 4)] = 1;
  labels[grid.index(5, 4, 4)] = 0;
  for (Index x = 30; x < 36; ++x) seeds[grid.index(x, 4, 4)] = 2;
  std::mt19937 random(2);
  std::normal_distribution<float> normal(0, 1);
  std::vector<float> values(voxels);
  for (float& value : values) value = normal(random);
  const auto divided = divide_by_seeds(grid, {values, 1, 1, {}, seeds, labels});
  ASSERT_EQ(divided.divided.size(), 1U);
  EXPECT_EQ(*divided.divided.begin(), (std::array<int, 2>{0, 1}));
  for (Index x = 0; x < 40; ++x) EXPECT_EQ(labels[grid.index(x, 4, 4)], x <= 17 ? 0 : 1) << x;
  // Nothing where an edge of the image is around the seed.
  std::fill(labels.begin(), labels.end(), std::uint8_t{1});
  for (Index x = 4; x < 7; ++x) {
    labels[grid.index(x, 4, 4)] = 0;
    values[grid.index(x, 4, 4)] += 10;
  }
  EXPECT_TRUE(divide_by_seeds(grid, {values, 1, 1, {}, seeds, labels}).empty());
}

}  // namespace
}  // namespace csrbf::divide_by_seeds_test
