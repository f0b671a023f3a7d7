#include "csrbf/levelset/regions/label_code.hpp"

#include "levelset/levelset_testing.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace csrbf {
namespace {

std::vector<std::uint8_t> labels_of(const Grid& grid, const std::function<bool(Index, Index, Index)>& inside) {
  std::vector<std::uint8_t> labels;
  for (Index z = 0; z < grid.size[2]; ++z)
    for (Index y = 0; y < grid.size[1]; ++y)
      for (Index x = 0; x < grid.size[0]; ++x) labels.push_back(inside(x, y, z) ? 1 : 0);
  return labels;
}

TEST(LabelCode, OfConstantLabelsIsThatOfOneProbability) {
  const Grid grid = square_grid(100);
  const std::vector<std::uint8_t> none(10000, 0);
  // Krichevsky and Trofimov: the product of (k + 1/2) / (k + 1), about 1 / sqrt(pi n).
  EXPECT_NEAR(label_code(none, grid, {}), 0.5 * std::log(std::numbers::pi * 10000), 1e-4);
}

TEST(LabelCode, OfNoiseIsItsEntropy) {
  const Grid grid = square_grid(200);
  std::mt19937 random(1);
  const auto labels = labels_of(grid, [&](Index, Index, Index) { return random() % 10 == 0; });
  const double entropy = 40000 * -(0.1 * std::log(0.1) + 0.9 * std::log(0.9));
  EXPECT_NEAR(label_code(labels, grid, {}), entropy, 0.05 * entropy);
}

TEST(LabelCode, OfStraightContoursIsShort) {
  const Grid grid = square_grid(120);
  const auto bars = labels_of(grid, [](Index x, Index, Index) { return x / 12 % 2 == 1; });
  const auto disc = labels_of(grid, [](Index x, Index y, Index) { return std::hypot(x - 60, y - 60) < 40; });
  EXPECT_LT(label_code(bars, grid, {}), 200);  // nats for 10 contours of 120 voxels
  EXPECT_LT(label_code(disc, grid, {}), 1.4 * 80 * std::numbers::pi);
  EXPECT_GT(label_code(disc, grid, {}), 0.5 * 80 * std::numbers::pi);
}

TEST(LabelCode, SeesTheSliceBefore) {
  Grid grid;
  grid.size = {30, 30, 30};
  std::mt19937 random(2);
  std::vector<bool> pattern(900);
  for (std::size_t i = 0; i < pattern.size(); ++i) pattern[i] = random() % 2 == 0;
  const auto labels = labels_of(grid, [&](Index x, Index y, Index) { return pattern[x + 30 * y]; });
  EXPECT_LT(label_code(labels, grid, {}), 3 * 900 * std::log(2.0));  // once, and what is learned on the way
}

TEST(LabelCode, LeavesOutWhatIsNotInTheMask) {
  const Grid grid = square_grid(60);
  std::mt19937 random(3);
  const auto left = labels_of(grid, [](Index x, Index, Index) { return x < 30; });
  const auto labels = labels_of(grid, [&](Index x, Index, Index) { return x < 30 && random() % 2 == 0; });
  std::vector<std::uint8_t> right(left.size());
  for (std::size_t i = 0; i < left.size(); ++i) right[i] = left[i] != 0 ? 0 : 1;
  EXPECT_GT(label_code(labels, grid, left), 1000);
  EXPECT_LT(label_code(labels, grid, right), 200);
}

TEST(LabelCode, IsTheSameWithAMaskOfAllVoxels) {
  Grid solid;
  solid.size = {37, 21, 19};
  for (const Grid& grid : {square_grid(61), solid}) {
    const auto labels = labels_of(grid, [](Index x, Index y, Index z) {
      return std::hypot(x - 20, y - 12, z - 4) < 11 || (x > 25 && y > 8) || x == 2;
    });
    EXPECT_EQ(label_code(labels, grid, {}), label_code(labels, grid, std::vector<std::uint8_t>(labels.size(), 1)));
  }
}

}  // namespace
}  // namespace csrbf
