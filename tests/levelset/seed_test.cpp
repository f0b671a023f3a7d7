#include "csrbf/levelset/seed.hpp"

#include <Eigen/Geometry>

#include "csrbf/core/error.hpp"

#include <gtest/gtest.h>

#include <numeric>

namespace csrbf::seed_test {
namespace {

// 20 x 30 (x 10) voxels, turned and stretched.
Grid grid_of(int dim) {
  Grid grid;
  grid.axes = dim;
  grid.size = {20, 30, dim == 3 ? 10 : 1};
  grid.spacing = {0.5, 0.4, 2};
  grid.origin = {3, -4, 7};
  grid.direction.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(0.5).toRotationMatrix();
  return grid;
}

template <int Dim>
Point<Dim> center(const Grid& grid, std::size_t voxel) {
  return grid.centers<Dim>().col(static_cast<Index>(voxel));
}

Index count(const Seed& seed) {
  return std::accumulate(seed.begin(), seed.end(), Index{0});
}

class Ball final : public Field<2> {
 public:
  Ball(const Point<2>& center, double radius) : center_(center), radius_(radius) {}
  void evaluate_block(const PointsRef<2>& x, const JetBlock& out) const override {
    for (Index i = 0; i < x.cols(); ++i) out.value[i] = radius_ - (x.col(i) - center_).norm();
  }
  [[nodiscard]] Box<2> bounds() const override { return {}; }

 private:
  Point<2> center_;
  double radius_;
};

TEST(Seed, OfABallHoldsTheVoxelsWhoseCentresAreInside) {
  const Grid grid = grid_of(3);
  const Point<3> middle = center<3>(grid, 3000);
  const Seed seed = seed_ball<3>(grid, middle, 2.55);
  ASSERT_EQ(seed.size(), 6000U);
  for (std::size_t i = 0; i < seed.size(); ++i)
    ASSERT_EQ(seed[i], (center<3>(grid, i) - middle).norm() <= 2.55 ? 1 : 0) << i;
  EXPECT_GT(count(seed), 50);
}

TEST(Seed, OfATinyBallHoldsTheVoxelAround) {
  const Grid grid = grid_of(2);
  const Seed seed = seed_ball<2>(grid, center<2>(grid, 123) + Point<2>(0.05, 0.05), 1e-3);
  EXPECT_EQ(count(seed), 1);
  EXPECT_EQ(seed[123], 1);
  EXPECT_EQ(count(seed_ball<2>(grid, Point<2>(1000, 0), 1e-3)), 0);
}

TEST(Seed, OfABoxLiesAlongThePhysicalAxes) {
  const Grid grid = grid_of(2);
  Box<2> box;
  box.add(center<2>(grid, 250));
  box.add(center<2>(grid, 250) + Point<2>(2, 3));
  const Seed seed = seed_box<2>(grid, box);
  for (std::size_t i = 0; i < seed.size(); ++i) ASSERT_EQ(seed[i], box.contains(center<2>(grid, i)) ? 1 : 0);
  EXPECT_GT(count(seed), 5);
}

TEST(Seed, OfAPolygonDoesNotDependOnTheOrderOfItsCorners) {
  Grid grid;
  grid.axes = 2;
  grid.size = {21, 21, 1};
  Points<2> square(2, 4), shuffled(2, 4);
  square << 4.5, 14.5, 14.5, 4.5, 2.5, 2.5, 9.5, 9.5;
  shuffled << 14.5, 4.5, 4.5, 14.5, 9.5, 2.5, 9.5, 2.5;
  const Seed seed = seed_polygon(grid, square);
  for (Index y = 0; y < 21; ++y)
    for (Index x = 0; x < 21; ++x) ASSERT_EQ(seed[grid.index(x, y)], x > 4 && x < 15 && y > 2 && y < 10 ? 1 : 0);
  EXPECT_EQ(seed_polygon(grid, shuffled), seed);
}

TEST(Seed, InsideAFieldIsWhereItIsPositive) {
  const Grid grid = grid_of(2);
  const Point<2> middle = center<2>(grid, 310);
  EXPECT_EQ(seed_inside<2>(grid, Ball(middle, 1.3)), seed_ball<2>(grid, middle, 1.3));
}

TEST(Seed, RefusesShapesThatAreNone) {
  const Grid grid = grid_of(2);
  EXPECT_THROW((void)seed_ball<2>(grid, Point<2>(0, 0), 0), InvalidInput);
  EXPECT_THROW((void)seed_ball<2>(grid, Point<2>(std::nan(""), 0), 1), InvalidInput);
  EXPECT_THROW((void)seed_box<2>(grid, Box<2>{}), InvalidInput);
  EXPECT_THROW((void)seed_polygon(grid, Points<2>::Zero(2, 2)), InvalidInput);
  EXPECT_THROW((void)seed_ball<2>(grid_of(3), Point<2>(0, 0), 1), InvalidInput);
}

}  // namespace
}  // namespace csrbf::seed_test
