#include "csrbf/spatial/convex_hull.hpp"

#include "csrbf/core/error.hpp"

#include <gtest/gtest.h>

#include <random>

namespace csrbf::convex_hull_test {
namespace {

TEST(ConvexHull, OfASquareIsTheSquare) {
  Points<2> x(2, 5);
  x << 0, 2, 0, 2, 1, 0, 0, 1, 1, .5;
  const HalfSpaces hull = convex_hull<2>(x);
  EXPECT_EQ(hull.offsets.size(), 4);
  EXPECT_TRUE(hull.contains(Point<2>(2, 1), 1e-12));
  EXPECT_TRUE(hull.contains(Point<2>(.3, .9), 0));
  EXPECT_FALSE(hull.contains(Point<2>(2.001, .5), 1e-12));
  EXPECT_FALSE(hull.contains(Point<2>(.3, -.001), 1e-12));
}

TEST(ConvexHull, OfPointsOnASphereIsNearlyTheBall) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  Points<3> x = Points<3>::NullaryExpr(3, 2000, [&] { return normal(random); });
  x.colwise().normalize();
  const HalfSpaces hull = convex_hull<3>(x);
  EXPECT_TRUE(hull.contains(Point<3>(.9, 0, 0), 0));
  EXPECT_FALSE(hull.contains(Point<3>(.7, .7, .2), 0));
}

TEST(ConvexHull, OfNumbersIsTheirRange) {
  const HalfSpaces hull = convex_hull<1>((Points<1>(1, 3) << 4, -1, 2).finished());
  EXPECT_TRUE(hull.contains(Point<1>(-1), 0));
  EXPECT_FALSE(hull.contains(Point<1>(4.1), 0));
}

TEST(ConvexHull, RefusesPointsOnALine) {
  Points<2> x(2, 4);
  x << 0, 1, 2, 3, 0, 1, 2, 3;
  EXPECT_THROW(convex_hull<2>(x), InvalidInput);
}

}  // namespace
}  // namespace csrbf::convex_hull_test
