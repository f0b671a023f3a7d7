#include "csrbf/spatial/tile_plan.hpp"

#include "csrbf/core/error.hpp"

#include <gtest/gtest.h>

#include <random>

namespace csrbf::tile_plan_test {
namespace {

Points<3> random_points(Index n) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Points<3> points(3, n);
  for (double& x : points.reshaped()) x = uniform(random);
  points.row(0) *= 5;
  return points;
}

TEST(TilePlan, TilesHaveEqualSharesAndFillSpace) {
  const Points<3> points = random_points(7000);
  for (const Index tiles : {1, 2, 7, 12}) {
    const TilePlan<3> plan(cut_into_tiles<3>(points, tiles), 0.01);
    ASSERT_EQ(plan.size(), tiles);
    std::vector<Index> count(tiles);
    for (Index i = 0; i < points.cols(); ++i) {
      const Index tile = plan.tile_of(points.col(i));
      EXPECT_TRUE(plan.box(tile).contains(points.col(i)));
      ++count[tile];
    }
    for (const Index n : count) EXPECT_NEAR(static_cast<double>(n), 7000.0 / static_cast<double>(tiles), 2);
    EXPECT_GE(plan.tile_of(Point<3>(100, -100, 7)), 0);
  }
}

TEST(TilePlan, ABoxMeetsTheTilesOfItsPoints) {
  const Points<3> points = random_points(2000);
  const TilePlan<3> plan(cut_into_tiles<3>(points, 9), 0.01);
  const Box<3> box{{-1, -0.4, -0.3}, {1.5, 0.2, 0.6}};
  std::vector<Index> expected;
  for (Index t = 0; t < plan.size(); ++t)
    if (plan.box(t).intersects(box)) expected.push_back(t);
  EXPECT_EQ(plan.tiles_in(box), expected);
}

TEST(TilePlan, DeepPointsAreFartherThanTheBlendFromAllFaces) {
  const TilePlan<3> plan({{0, -1, -2, 0.5}}, 0.1);
  EXPECT_EQ(plan.tile_of(Point<3>(0.45, 0, 0)), 0);
  EXPECT_FALSE(plan.is_deep(Point<3>(0.45, 0, 0), 0));
  EXPECT_TRUE(plan.is_deep(Point<3>(0.39, 0, 1e9), 0));
  EXPECT_TRUE(plan.is_deep(Point<3>(0.61, 0, 0), 1));
}

TEST(TilePlan, CutsThatAreNoTreeAreRefused) {
  EXPECT_THROW(TilePlan<3>({{0, 0, -1, 0.5}}, 0.1), InvalidInput);  // its own side
  EXPECT_THROW(TilePlan<3>({{3, -1, -2, 0.5}}, 0.1), InvalidInput);
  EXPECT_THROW(TilePlan<3>({{0, -1, -1, 0.5}}, 0.1), InvalidInput);  // the second tile is missing
  EXPECT_THROW(TilePlan<3>({}, -1), InvalidInput);
}

}  // namespace
}  // namespace csrbf::tile_plan_test
