#include "csrbf/surface/normals/orient_normals.hpp"

#include "core/error_testing.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/surface/estimate_normals.hpp"
#include "surface/oriented_shapes.hpp"

#include <gtest/gtest.h>

#include <string>

namespace csrbf::orient_normals_test {
namespace {

// Share of normals on the right side after exact normals with random signs were oriented.
double share_after(const Shape& shape, OrientReport* report = nullptr) {
  Points<3> normals = scrambled(shape.normals, 99);
  const OrientReport result = orient_normals(shape.points, normals);
  if (report != nullptr) *report = result;
  return outward_share(normals, shape.normals);
}

Shape inward(Shape shape) {
  shape.normals = -shape.normals;
  return shape;
}

// The part of a shape where keep(p) holds.
template <class Keep>
Shape part(const Shape& shape, Keep keep) {
  Shape kept{Points<3>(3, shape.size()), Points<3>(3, shape.size()), 0};
  Index count = 0;
  for (Index i = 0; i < shape.size(); ++i) {
    if (!keep(Point<3>(shape.points.col(i)))) continue;
    kept.points.col(count) = shape.points.col(i);
    kept.normals.col(count++) = shape.normals.col(i);
  }
  kept.points.conservativeResize(3, count);
  kept.normals.conservativeResize(3, count);
  kept.area = shape.area * static_cast<double>(count) / static_cast<double>(shape.size());
  return kept;
}

TEST(OrientNormals, OfOneSolidPointOutward) {
  OrientReport report;
  EXPECT_EQ(share_after(random_sphere(3000, 1), &report), 1);
  EXPECT_EQ(report.method, OrientMethod::spanning_tree);
  EXPECT_LT(report.ambiguity, 0.02);
  EXPECT_NEAR(report.flipped_edges, 0.5, 0.05);  // random signs
  EXPECT_EQ(share_after(random_torus(5000, 2)), 1);
  EXPECT_EQ(share_after(random_box({1, 1, 1}, 0.05, 3)), 1);
}

TEST(OrientNormals, KeepLinesAndLengthsOfTheNormals) {
  const Shape torus = random_torus(3000, 4);
  Points<3> normals = scrambled(torus.normals, 5);
  for (Index i = 0; i < torus.size(); ++i) normals.col(i) *= 1 + static_cast<double>(i % 7);
  normals.col(17).setZero();
  Points<3> oriented = normals;
  const OrientReport report = orient_normals(torus.points, oriented);
  Index turned = 0;
  for (Index i = 0; i < torus.size(); ++i) {
    EXPECT_TRUE(oriented.col(i) == normals.col(i) || oriented.col(i) == -normals.col(i));
    turned += oriented.col(i) == normals.col(i) ? 0 : 1;
  }
  EXPECT_NEAR(report.turned, static_cast<double>(turned) / 3000, 1e-12);
  EXPECT_GE(outward_share(oriented, torus.normals), 1 - 1.5 / 3000);  // all but the zero one
}

TEST(OrientNormals, OfSeparateSolidsAllPointOutward) {
  const Shape spheres =
      join(join(random_sphere(4000, 6), random_sphere(800, 7, {4, 1, 0}, 0.4)), random_sphere(200, 8, {-3, 1, 2}, 0.1));
  OrientReport report;
  EXPECT_EQ(share_after(spheres, &report), 1);
  EXPECT_LT(report.ambiguity, 0.02);
}

// Signs that the spanning tree leaves mixed.
TEST(OrientNormals, OfManySeparateSolidsAllPointOutward) {
  Shape solids;
  for (unsigned i = 0; i < 25; ++i) solids = join(solids, random_sphere(300, i, {3.0 * (i % 5), 3.0 * (i / 5), 0}));
  EXPECT_EQ(share_after(solids), 1);
}

TEST(OrientNormals, OfACavityPointIntoIt) {
  OrientReport report;
  EXPECT_EQ(share_after(join(random_sphere(6000, 9), inward(random_sphere(1500, 10, {0.1, 0, 0}, 0.5))), &report), 1);
  EXPECT_EQ(report.method, OrientMethod::winding_number);
  EXPECT_LT(report.ambiguity, report.ambiguity_tree);
}

TEST(OrientNormals, OfASolidInACavityPointOutwardAgain) {
  const Shape shells = join(join(random_sphere(8000, 11), inward(random_sphere(4000, 12, {0, 0, 0}, 0.7))),
                            random_sphere(1500, 13, {0, 0, 0}, 0.4));
  EXPECT_EQ(share_after(shells), 1);
}

TEST(OrientNormals, OfTouchingSolidsPointOutward) {
  // The tree runs straight across the gap: the normals there are parallel, but must not be equal.
  const Shape spheres = join(random_sphere(8000, 14), random_sphere(8000, 15, {2.05, 0, 0}, 1));
  OrientReport report;
  EXPECT_GT(share_after(spheres, &report), 0.999);
  EXPECT_EQ(report.method, OrientMethod::winding_number);
  EXPECT_GT(report.ambiguity_tree, 10 * report.ambiguity);
}

TEST(OrientNormals, OfThinPlatesPointOutward) {
  // Sheets two spacings apart; normals estimated, the rim is not resolved.
  const Shape plate = random_box({1, 1, 0.03}, 0.03, 16);
  const Points<3> normals = estimate_normals(plate.points);
  EXPECT_GT(outward_share(normals, plate.normals), 0.995);
}

TEST(OrientNormals, OfABladePointOutward) {
  // A wedge of 17 degrees: near its edge neighbours of both faces look alike, and the tree crosses there.
  Shape wedge = random_box({1, 1, 0.15}, 0.03, 17);
  for (Index i = 0; i < wedge.size(); ++i) {
    Point<3> p = wedge.points.col(i), n = wedge.normals.col(i);
    if (std::abs(n[2]) == 1) n = Point<3>(-0.075, 0, n[2]).normalized();
    p[2] *= 0.5 * (1 + p[0]);
    wedge.points.col(i) = p;
    wedge.normals.col(i) = n;
  }
  const Shape blade = part(wedge, [](const Point<3>& p) { return p[0] > -1; });
  // A fifth of it is thinner than two spacings, where either side may win.
  EXPECT_GT(outward_share(estimate_normals(blade.points), blade.normals), 0.9);
}

TEST(OrientNormals, OfPatchesWithGapsAgree) {
  const auto keep = [](const Point<3>& p) {
    const double latitude = std::asin(p[2]), longitude = std::atan2(p[1], p[0]);
    return std::abs(std::remainder(latitude, 0.5)) > 0.08 &&
           std::abs(std::remainder(longitude, 0.7)) * std::hypot(p[0], p[1]) > 0.08;
  };
  EXPECT_EQ(share_after(part(random_sphere(20000, 18), keep)), 1);
}

TEST(OrientNormals, OfAnOpenSheetPointUp) {
  const Shape cap = part(random_sphere(20000, 19), [](const Point<3>& p) { return p[2] > 0.9; });
  EXPECT_EQ(share_after(cap), 1);
  Shape bowl = cap;
  bowl.points.row(2) *= -1;
  bowl.normals.row(0) *= -1;
  bowl.normals.row(1) *= -1;
  EXPECT_EQ(share_after(bowl), 1);
  const Shape dome = part(random_sphere(5000, 20), [](const Point<3>& p) { return p[2] < 0; });
  EXPECT_EQ(share_after(dome), 1);  // a hemisphere has an inside
}

// Each of them alone is nearly a solid.
TEST(OrientNormals, OfHillsAndHousesPointUp) {
  for (const double height : {0.1, 0.15})
    EXPECT_EQ(share_after(random_hills(20'000, height, 24, 0.4 / std::sqrt(20'000))), 1) << height;
  const Shape houses = random_houses(20'000, 25);
  Points<3> fitted = estimate_normals(houses.points, {.orient = Orient::none});
  orient_normals(houses.points, fitted);
  EXPECT_GT(outward_share(fitted, houses.normals), 0.99);
}

TEST(OrientNormals, BearNoiseAndUnevenDensity) {
  const double diagonal = std::hypot(2 * (torus_major + torus_minor), 2 * (torus_major + torus_minor), 2 * torus_minor);
  EXPECT_EQ(share_after(random_torus(5000, 21, 0.005 * diagonal)), 1);
  std::mt19937_64 random(22);
  std::uniform_real_distribution<double> uniform;
  const Shape uneven = part(random_torus(40000, 23), [&](const Point<3>& p) {
    return uniform(random) < std::pow(10, -1.2 * (p[0] + 1.35) / 1.35);
  });
  EXPECT_LT(uneven.size(), 12000);
  EXPECT_EQ(share_after(uneven), 1);
}

TEST(OrientNormals, AreInvariantUnderSimilarities) {
  const Shape shells = join(random_sphere(3000, 24), inward(random_sphere(1000, 25, {0, 0, 0}, 0.5)));
  for (const double scale : {1e-30, 1.0, 1e30}) {
    Shape moved = shells;
    moved.points = (scale * some_rotation() * shells.points).colwise() + scale * Point<3>(3, -4, 5);
    moved.normals = some_rotation() * shells.normals;
    EXPECT_EQ(share_after(moved), 1) << scale;
  }
}

TEST(OrientNormals, DoNotDependOnTheNumberOfThreads) {
  const Shape spheres = join(random_torus(3000, 26, 0.03), random_sphere(1000, 27, {4, 1, 0}, 0.4));
  set_thread_count(1);
  Points<3> normals = scrambled(spheres.normals, 28);
  orient_normals(spheres.points, normals);
  for (const int threads : {2, 5}) {
    set_thread_count(threads);
    Points<3> again = scrambled(spheres.normals, 28);
    orient_normals(spheres.points, again);
    EXPECT_EQ(again, normals);
  }
  set_thread_count(0);
}

TEST(OrientNormals, OfFewPointsAreLeftOrFollowTheRules) {
  Points<3> none(3, 0);
  EXPECT_EQ(orient_normals(none, none).turned, 0);
  Points<3> one = Point<3>(0, 0, -1);
  orient_normals(Point<3>(1, 2, 3), one);
  EXPECT_EQ(one, Point<3>(0, 0, -1));
  Points<3> zero = Points<3>::Zero(3, 50);
  orient_normals(random_sphere(50, 29).points, zero);
  EXPECT_EQ(zero, (Points<3>::Zero(3, 50)));
  Points<3> two = (Points<3>(3, 2) << 0, 0, 0, 0, -1, 1).finished();
  orient_normals((Points<3>(3, 2) << 0, 1, 0, 0, 0, 0).finished(), two);
  EXPECT_EQ(two.row(2), Eigen::RowVector2d(1, 1));
}

TEST(OrientationConsistency, IsOneForGoodNormalsAndHalfForRandomSigns) {
  const Shape torus = random_torus(5000, 30);
  EXPECT_EQ(orientation_consistency(torus.points, torus.normals), 1);
  EXPECT_EQ(orientation_consistency(torus.points, -torus.normals), 1);
  EXPECT_NEAR(orientation_consistency(torus.points, scrambled(torus.normals, 31)), 0.5, 0.05);
  EXPECT_EQ(orientation_consistency(torus.points, Points<3>::Zero(3, 5000)), 1);
  EXPECT_EQ(orientation_consistency(Points<3>(3, 0), Points<3>(3, 0)), 1);
}

TEST(OrientationConsistency, SeesTurnedPatchesButNotTheTwoSidesOfAPlate) {
  const Shape plate = random_box({1, 1, 0.03}, 0.03, 32);
  EXPECT_EQ(orientation_consistency(plate.points, plate.normals), 1);
  const Shape sphere = random_sphere(20000, 33);
  Points<3> patched = sphere.normals;
  for (Index i = 0; i < sphere.size(); ++i)
    if (std::remainder(sphere.points(2, i), 0.2) > 0) patched.col(i) *= -1;
  const double consistency = orientation_consistency(sphere.points, patched);
  EXPECT_LT(consistency, 0.9);  // 20 borders with pairs reaching 2 of the 4 spacings between borders
  EXPECT_GT(consistency, 0.5);
  orient_normals(sphere.points, patched);
  EXPECT_EQ(outward_share(patched, sphere.normals), 1);
}

TEST(OrientNormals, RejectWhatMakesNoSense) {
  const Shape sphere = random_sphere(100, 34);
  Points<3> normals = sphere.normals.leftCols(99);
  EXPECT_EQ(invalid_input_message([&] { orient_normals(sphere.points, normals); }),
            "orient_normals: normals.cols() = 99: must be the number of points");
  normals = sphere.normals;
  EXPECT_EQ(invalid_input_message([&] { orient_normals(sphere.points, normals, {.neighbors = 2}); }),
            "orient_normals: neighbors = 2: must be at least 3; 12 is usual");
  normals(0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(invalid_input_message([&] { orient_normals(sphere.points, normals); }),
            "orient_normals: normals = NaN or infinity: must be finite; set unknown normals to zero");
  EXPECT_EQ(invalid_input_message([&] {
              orientation_consistency(sphere.points * std::numeric_limits<double>::infinity(), sphere.normals);
            }),
            "orientation_consistency: points = NaN or infinity: must be finite; remove such points");
}

TEST(OrientNormals, StopWhenTold) {
  const Shape sphere = random_sphere(500, 35);
  Points<3> normals = scrambled(sphere.normals, 36), before = normals;
  EXPECT_THROW(orient_normals(sphere.points, normals, {.progress = [](std::string_view, double f) { return f < 0.5; }}),
               Cancelled);
  EXPECT_EQ(normals, before);
}

// A ball beside a wavy sheet: neither tells the side of the other.
TEST(OrientNormals, BodiesAboveTheGroundFaceOutward) {
  for (const double radius : {0.06, 0.15}) {
    const Index on_ground = 5000;
    const PointCloud ball =
        sphere_cloud(static_cast<Index>(4 * pi * on_ground * radius * radius), 1, radius, {0.3, 0.5, 0.3});
    Points<3> points(3, on_ground + ball.size());
    points.rightCols(ball.size()) = ball.points;
    for (Index i = 0; i < on_ground; ++i) {
      const Eigen::Vector2d p = quasi_random(i, 1);
      points.col(i) << p, 0.05 * std::sin(9 * p[0]) * std::cos(8 * p[1]);
    }
    const Points<3> normals = estimate_normals(points);
    EXPECT_EQ((normals.leftCols(on_ground).row(2).array() <= 0).count(), 0) << radius;
    EXPECT_EQ((normals.rightCols(ball.size()).cwiseProduct(ball.normals).colwise().sum().array() <= 0).count(), 0)
        << radius;
  }
}

}  // namespace
}  // namespace csrbf::orient_normals_test
