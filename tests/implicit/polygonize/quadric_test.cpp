#include "csrbf/implicit/polygonize/quadric.hpp"

#include <gtest/gtest.h>

#include <random>

namespace csrbf::polygonization::quadric_test {
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

struct Plane {
  Point<3> point, normal;
};

std::vector<Plane> random_planes(std::size_t n, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto vector = [&] { return Point<3>(uniform(random), uniform(random), uniform(random)); };
  std::vector<Plane> planes;
  for (std::size_t i = 0; i < n; ++i) planes.push_back({vector(), vector().normalized()});
  return planes;
}

TEST(Quadric, MeasuresTheRootMeanSquareDistanceFromAllPlanesOfASum) {
  const std::vector<Plane> planes = random_planes(7, 1);
  Quadric all, some, others;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    all.add(planes[i].point, planes[i].normal);
    (i < 3 ? some : others).add(planes[i].point, planes[i].normal);
  }
  some += others;
  Point<3> mean = Point<3>::Zero();
  for (const Plane& plane : planes) mean += plane.point / 7;
  EXPECT_LT((some.mean() - mean).norm(), rounding);
  for (const Plane& at : random_planes(20, 2)) {
    double sum = 0;
    for (const Plane& plane : planes) sum += std::pow(plane.normal.dot(at.point - plane.point), 2);
    EXPECT_NEAR(all.distance(at.point), std::sqrt(sum / 7), rounding);
    EXPECT_NEAR(some.distance(at.point), std::sqrt(sum / 7), rounding);
  }
  const Box<3> everywhere{Point<3>::Constant(-1e9), Point<3>::Constant(1e9)};
  EXPECT_LT((some.minimizer(everywhere) - all.minimizer(everywhere)).norm(), 1e-9);
}

// Where the planes would have it is away from the mean, so one or two sides of the box bind.
TEST(Quadric, PutsThePointWhereTheSumCannotGetLessWithinTheBox) {
  const Box<3> box{Point<3>(-0.1, -0.2, -0.1), Point<3>(0.2, 0.1, 0.3)};
  int bound = 0;
  for (unsigned seed = 0; seed < 50; ++seed) {
    const std::vector<Plane> planes = random_planes(5, 10 + seed);
    Quadric quadric;
    for (const Plane& plane : planes) quadric.add(plane.point, plane.normal);
    const Point<3> x = quadric.minimizer(box);
    EXPECT_TRUE(box.contains(x));
    Point<3> slope = Point<3>::Zero();  // half the gradient of the sum
    for (const Plane& plane : planes) slope += plane.normal.dot(x - plane.point) * plane.normal;
    const double pull = 5e-3 * (x - quadric.mean()).norm();  // to the mean: a thousandth of an eigenvalue of at most 5
    for (int axis = 0; axis < 3; ++axis) {
      const bool above = x[axis] > box.lo[axis], below = x[axis] < box.hi[axis];
      EXPECT_TRUE(!above || slope[axis] < pull + rounding);
      EXPECT_TRUE(!below || slope[axis] > -pull - rounding);
      bound += !above || !below;
    }
  }
  EXPECT_GT(bound, 20);
}

}  // namespace
}  // namespace csrbf::polygonization::quadric_test
