#include "csrbf/levelset/seeded/divide_by_seeds.hpp"

#include "csrbf/levelset/seeded/nearest_seeds.hpp"
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

// All of a border tells two regions apart, where what is near one of its pixels does not.
TEST(DivideBySeeds, LeavesAFaintDiscAlone) {
  VolumeLayout layout;
  layout.grid.size = {160, 160, 1};
  Volume<float> image(layout);
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0, 1);
  std::vector<std::uint8_t> truth(image.values.size());
  SegmentOptions options;
  options.seeds.assign(truth.size(), 0);
  for (Index y = 0; y < 160; ++y)
    for (Index x = 0; x < 160; ++x) {
      const Index i = layout.grid.index(x, y, 0);
      truth[i] = std::hypot(x - 80, y - 80) < 40 ? 1 : 0;
      image.values[i] = static_cast<float>(0.7 * truth[i] + normal(random));
      if (std::abs(x - 80) < 3 && std::abs(y - 80) < 3) options.seeds[i] = 2;
      if (std::abs(x - 10) < 3 && std::abs(y - 10) < 3) options.seeds[i] = 1;
    }
  const Segmentation<2> found = segment<2>(image, options);
  EXPECT_GT(dice(found.labels, truth, 1), 0.95);
  EXPECT_TRUE(found.report.warnings.empty());
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

// Seeds that may be wrong divide nothing.
TEST(DivideBySeeds, TakesSeedsThatAreCertainOnly) {
  SegmentOptions options = with_seeds(1);
  options.seed_confidence = 0.9;
  EXPECT_TRUE(segment<3>(image_of(two_balls(), {40, 100, 100}, 6), options).report.warnings.empty());
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

// Borders are midway on a bar, whatever its voxels and those of the seeds.
TEST(NearestSeeds, MeasuresAlongPaths) {
  Grid grid;
  grid.size = {40, 9, 9};
  grid.spacing = {1, 2, 2};
  const auto voxels = static_cast<std::size_t>(grid.voxels());
  std::vector<std::uint8_t> labels(voxels, 1), seeds(voxels, 0);
  seeds[grid.index(5, 4, 4)] = 1;
  for (Index x = 30; x < 36; ++x) seeds[grid.index(x, 4, 4)] = 2;
  EXPECT_TRUE(nearest_seeds(grid, std::vector<std::int32_t>(voxels, 0), seeds, labels).empty());
  for (Index x = 0; x < 40; ++x) EXPECT_EQ(labels[grid.index(x, 4, 4)], x <= 17 ? 0 : 1) << x;
}

}  // namespace
}  // namespace csrbf::divide_by_seeds_test
