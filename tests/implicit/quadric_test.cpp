#include "csrbf/implicit/quadric.hpp"

#include <gtest/gtest.h>

namespace csrbf::polygonization {
namespace {

const Box<3> unit_box{Point<3>::Zero(), Point<3>::Ones()};
constexpr double rounding = 1e-12;

TEST(Quadric, PutsThePointWhereThreePlanesMeet) {
  const Point<3> corner(0.3, 0.6, 0.2);
  Quadric quadric;
  for (int axis = 0; axis < 3; ++axis)
    quadric.add(corner + Point<3>::Constant(0.1) - 0.1 * Point<3>::Unit(axis), Point<3>::Unit(axis));
  EXPECT_LT((quadric.minimizer(unit_box) - corner).norm(), rounding);
  EXPECT_NEAR(quadric.distance(corner), 0, 1e-8);  // the root of rounding
  EXPECT_NEAR(quadric.distance(corner + Point<3>(0.3, 0, 0)), std::sqrt(0.09 / 3), rounding);
}

TEST(Quadric, StaysNextToTheMeanAlongAnEdgeAndOnAPlane) {
  Quadric edge;
  edge.add({0.5, 0.1, 0.2}, Point<3>::UnitX());
  edge.add({0.1, 0.5, 0.6}, Point<3>::UnitY());
  EXPECT_LT((edge.minimizer(unit_box) - Point<3>(0.5, 0.5, 0.4)).norm(), rounding);
  Quadric plane;
  plane.add({0.2, 0.1, 0.5}, Point<3>::UnitZ());
  plane.add({0.6, 0.3, 0.5}, Point<3>::UnitZ());
  EXPECT_LT((plane.minimizer(unit_box) - Point<3>(0.4, 0.2, 0.5)).norm(), rounding);
}

TEST(Quadric, TakesPlanesThatAreNearlyParallelAsOne) {
  Quadric quadric;  // they meet far away
  const double angle = 0.01;
  quadric.add({0.2, 0.5, 0.5}, Point<3>(std::sin(angle), 0, std::cos(angle)));
  quadric.add({0.8, 0.5, 0.5}, Point<3>(-std::sin(angle), 0, std::cos(angle)));
  EXPECT_LT((quadric.minimizer(unit_box) - Point<3>(0.5, 0.5, 0.5)).norm(), 0.6 * angle);
}

TEST(Quadric, FindsTheBestPointOfTheBoxWhenThePlanesMeetOutside) {
  const Point<3> corner(1.5, 0.4, 0.3);
  Quadric quadric;
  for (int axis = 0; axis < 3; ++axis) quadric.add(corner, Point<3>::Unit(axis));
  // The nearest point of the box but for the pull to the mean, a thousandth.
  EXPECT_LT((quadric.minimizer({Point<3>::Zero(), Point<3>(1, 0.35, 1)}) - Point<3>(1, 0.35, 0.3)).norm(), 1e-3);
}

TEST(Quadric, SumsAndKnowsOnlyTheMeanWithoutPlanes) {
  Quadric a, b;
  a.add({0.2, 0.2, 0.2}, Point<3>::Zero());
  b.add({0.4, 0.4, 0.4}, Point<3>::Zero());
  a += b;
  EXPECT_LT((a.minimizer(unit_box) - Point<3>::Constant(0.3)).norm(), rounding);
  EXPECT_EQ(a.distance(Point<3>::Zero()), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace csrbf::polygonization
