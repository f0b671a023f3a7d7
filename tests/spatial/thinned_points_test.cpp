#include "csrbf/spatial/thinned_points.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace csrbf::thinned_points_test {
namespace {

Points<3> on_sphere(Index n) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  Points<3> points(3, n);
  for (double& x : points.reshaped()) x = normal(random);
  points.colwise().normalize();
  return points;
}

TEST(ThinnedPoints, SpacingIsThatOfAllPointsWhateverTheSample) {
  const Points<3> points = on_sphere(20000);
  const double expected = std::sqrt(4 * 3.14159265 / 20000);
  EXPECT_NEAR(typical_spacing<3>(points, 20000, 2), expected, 0.15 * expected);
  EXPECT_NEAR(typical_spacing<3>(points.leftCols(2000), 20000, 2), expected, 0.15 * expected);
}

// Each level has a point in every cube that has any, and about a fourth of the level before.
TEST(ThinnedPoints, LevelsHaveOnePointPerCube) {
  const Points<3> points = on_sphere(20000);
  const ThinningGrid<3> grid = ThinningGrid<3>::over(bounding_box<3>(points), typical_spacing<3>(points, 20000, 2));
  const ThinnedPoints thinned = thin<3>(points, grid);
  ASSERT_EQ(static_cast<int>(thinned.levels.size()), grid.levels() - 1);
  for (std::size_t level = 0; level < thinned.levels.size(); ++level) {
    const int shift = 3 * (grid.spacing_bits + static_cast<int>(level) + 1);
    std::set<std::uint64_t> cubes, chosen;
    for (Index i = 0; i < points.cols(); ++i) cubes.insert(grid.key(points.col(i)) >> shift);
    for (const Index i : thinned.levels[level]) chosen.insert(grid.key(points.col(thinned.order[i])) >> shift);
    EXPECT_EQ(chosen, cubes);
    EXPECT_EQ(thinned.levels[level].size(), cubes.size());
  }
  const double ratio = static_cast<double>(thinned.levels[2].size()) / static_cast<double>(thinned.levels[1].size());
  EXPECT_NEAR(ratio, 0.25, 0.05);
}

TEST(ThinnedPoints, SpacingInSpaceIsTheSideOfTheCubeOfEachPoint) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(0, 2);
  Points<4> points(4, 4000);
  for (double& x : points.reshaped()) x = uniform(random);
  const double expected = 2 / std::pow(4000, 0.25);
  EXPECT_NEAR(typical_spacing<4>(points, 4000, 4), expected, 0.2 * expected);
}

// On a line there are more cubes than in space: the finest still tell neighbours apart.
TEST(ThinnedPoints, CubesAreFinerInFewerDimensions) {
  const ThinningGrid<1> grid = ThinningGrid<1>::over({Point<1>(0), Point<1>(1)}, 1e-7);
  EXPECT_NE(grid.key(Point<1>(0.5)), grid.key(Point<1>(0.5 + 1e-8)));
  EXPECT_LT(grid.key(Point<1>(0.1)), grid.key(Point<1>(0.2)));
}

TEST(ThinnedPoints, LevelsDoubleTheirDistance) {
  EXPECT_EQ(level_at(0, 0.1), 0);
  EXPECT_EQ(level_at(0.1, 0.1), 0);
  EXPECT_EQ(level_at(0.11, 0.1), 1);
  EXPECT_EQ(level_at(0.2, 0.1), 1);
  EXPECT_EQ(level_at(0.21, 0.1), 2);
  EXPECT_EQ(level_at(0.8, 0.1), 3);
}

}  // namespace
}  // namespace csrbf::thinned_points_test
