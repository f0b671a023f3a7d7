#include "csrbf/implicit/mesh/triangle_tree.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/implicit/mesh/triangle_geometry.hpp"
#include "implicit/mesh_testing.hpp"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <random>

namespace csrbf::triangle_tree_test {
namespace {

// Distances come out of a handful of products of numbers of order one.
constexpr double rounding = 1e-13;

// Independent triangles of random size and shape, among them needles and ones degenerate to a segment or a point.
Mesh triangle_soup(Index n, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  Mesh mesh;
  mesh.vertices.resize(3, 3 * n);
  mesh.triangles.resize(3, n);
  for (Index t = 0; t < n; ++t) {
    const Point<3> corner(uniform(random), uniform(random), uniform(random));
    const double size = 0.2 * std::pow(uniform(random), 4);
    for (int k = 0; k < 3; ++k) {
      mesh.vertices.col(3 * t + k) = corner + size * Point<3>(normal(random), normal(random), normal(random));
      mesh.triangles(k, t) = static_cast<std::int32_t>(3 * t + k);
    }
    auto a = mesh.vertices.col(3 * t), b = mesh.vertices.col(3 * t + 1), c = mesh.vertices.col(3 * t + 2);
    if (t % 10 == 0) c = (a + 0.3 * (b - a)).eval();
    if (t % 10 == 1) b = a + 1e-7 * (b - a);
    if (t % 50 == 2) b = c = a;
  }
  return mesh;
}

double brute_force_distance(const Mesh& mesh, const Point<3>& x) {
  double best = std::numeric_limits<double>::infinity();
  for (Index t = 0; t < mesh.triangles.cols(); ++t) {
    const auto corner = [&](int k) -> Point<3> { return mesh.vertices.col(mesh.triangles(k, t)); };
    best = std::min(best, closest_on_triangle(x, corner(0), corner(1), corner(2)).squared_distance);
  }
  return std::sqrt(best);
}

// Hit of a ray with the plane of each triangle, inside by three signed volumes (not the test of the tree).
double brute_force_hit(const Mesh& mesh, const Point<3>& origin, const Point<3>& direction) {
  double best = std::numeric_limits<double>::infinity();
  for (Index t = 0; t < mesh.triangles.cols(); ++t) {
    const Point<3> a = mesh.vertices.col(mesh.triangles(0, t)) - origin;
    const Point<3> b = mesh.vertices.col(mesh.triangles(1, t)) - origin;
    const Point<3> c = mesh.vertices.col(mesh.triangles(2, t)) - origin;
    const double u = direction.dot(b.cross(c)), v = direction.dot(c.cross(a)), w = direction.dot(a.cross(b));
    const Point<3> n = area_vector(a, b, c);
    const bool inside = (u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0);
    if (!inside || n.dot(direction) == 0) continue;
    const double hit = n.dot(a) / n.dot(direction);
    if (hit >= 0) best = std::min(best, hit);
  }
  return best;
}

TEST(TriangleTree, FindsTheClosestPointOnFaceEdgeAndVertex) {
  const TriangleTree tree(right_triangle());
  EXPECT_NEAR(tree.closest({0.5, 0.5, 3}).distance, 3, rounding);
  EXPECT_TRUE(tree.closest({0.5, 0.5, 3}).point.isApprox(Point<3>(0.5, 0.5, 0), rounding));
  EXPECT_NEAR(tree.closest({2, 2, 0}).distance, std::sqrt(2.0), rounding);
  EXPECT_TRUE(tree.closest({2, 2, 0}).point.isApprox(Point<3>(1, 1, 0), rounding));
  EXPECT_NEAR(tree.closest({5, -4, 0}).distance, 5, rounding);
  EXPECT_EQ(tree.closest({5, -4, 0}).triangle, 0);
}

// A point q of a convex set is the closest to x exactly when no vertex v has (x - q).(v - q) > 0.
TEST(ClosestOnTriangle, SatisfiesTheOptimalityConditionOfConvexSetsEvenOnDegenerateTriangles) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  const Mesh mesh = triangle_soup(3000, random);
  for (Index t = 0; t < mesh.triangles.cols(); ++t) {
    const Eigen::Matrix3d v = mesh.vertices.middleCols(3 * t, 3);
    const double size = (v.colwise() - v.col(0)).colwise().norm().maxCoeff();
    const Point<3> x = v.col(0) + 2 * size * Point<3>(normal(random), normal(random), normal(random));
    const auto [q, squared_distance] = closest_on_triangle(x, v.col(0), v.col(1), v.col(2));
    // Rounding over the smallest aspect ratio of the soup, and rounding of coordinates of order one.
    const double tolerance = 1e-8 * size * size + 1e-14 * size;
    for (int k = 0; k < 3; ++k) EXPECT_LE((x - q).dot(v.col(k) - q), tolerance);
    EXPECT_NEAR(squared_distance, (x - q).squaredNorm(), tolerance);
    double parts = 0;
    for (int k = 0; k < 3; ++k) parts += area_vector(q, v.col(k), v.col((k + 1) % 3)).norm();
    EXPECT_NEAR(parts, area_vector(v.col(0), v.col(1), v.col(2)).norm(), tolerance);
  }
}

TEST(TriangleTree, FindsTheHitOfARayWithBarycentricWeights) {
  const TriangleTree tree(right_triangle());
  const auto hit = tree.first_hit({0.5, 1, 4}, {0, 0, -2});
  ASSERT_EQ(hit.triangle, 0);
  EXPECT_NEAR(hit.t, 2, rounding);
  EXPECT_TRUE(hit.weights.isApprox(Point<3>(0.25, 0.25, 0.5), rounding));
  EXPECT_EQ(tree.first_hit({0.5, 1, 4}, {0, 0, -2}, 1.9).triangle, -1);
  EXPECT_EQ(tree.first_hit({0.5, 1, 4}, {0, 0, 2}).triangle, -1);
  EXPECT_EQ(tree.first_hit({3, 1, 4}, {0, 0, -2}).triangle, -1);
  EXPECT_EQ(tree.first_hit({0.5, 1, 4}, {0, 0, 0}).triangle, -1);
  EXPECT_TRUE(tree.occluded({0.5, 1, -4}, {0, 0, 1}));
  EXPECT_FALSE(tree.occluded({0.5, 1, -4}, {0, 0, 1}, 3.9));
}

TEST(TriangleTree, ClosestDistanceEqualsBruteForceOnASoupWithDegenerateTriangles) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-0.5, 1.5);
  const Mesh mesh = triangle_soup(1000, random);
  const TriangleTree tree(mesh);
  for (int i = 0; i < 1000; ++i) {
    const Point<3> x(uniform(random), uniform(random), uniform(random));
    const auto closest = tree.closest(x);
    EXPECT_NEAR(closest.distance, brute_force_distance(mesh, x), rounding);
    EXPECT_NEAR((closest.point - x).norm(), closest.distance, rounding);
  }
}

TEST(TriangleTree, FirstHitEqualsBruteForceOnASoupWithDegenerateTriangles) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> uniform(-0.5, 1.5);
  std::normal_distribution<double> normal;
  const Mesh mesh = triangle_soup(1000, random);
  const TriangleTree tree(mesh);
  int hits = 0;
  for (int i = 0; i < 3000; ++i) {
    const Point<3> origin(uniform(random), uniform(random), uniform(random));
    const Point<3> direction(normal(random), normal(random), normal(random));
    const auto hit = tree.first_hit(origin, direction);
    const double expected = brute_force_hit(mesh, origin, direction);
    ASSERT_EQ(hit.triangle >= 0, std::isfinite(expected));
    EXPECT_EQ(tree.occluded(origin, direction), std::isfinite(expected));
    if (!std::isfinite(expected)) continue;
    ++hits;
    constexpr double needle_rounding = 1e-7;  // a needle's plane is known to rounding over its aspect ratio
    EXPECT_NEAR(hit.t, expected, needle_rounding * (1 + expected));
    Point<3> point = Point<3>::Zero();
    for (int k = 0; k < 3; ++k) point += hit.weights[k] * mesh.vertices.col(mesh.triangles(k, hit.triangle));
    EXPECT_NEAR((origin + hit.t * direction - point).norm(), 0, needle_rounding);
  }
  EXPECT_GT(hits, 300);
}

TEST(TriangleTree, AxisParallelRaysThroughVerticesAndEdgesDoNotSlipThrough) {
  const Mesh mesh = unit_sphere(16);
  const TriangleTree tree(mesh);
  for (Index v = 0; v < mesh.vertices.cols(); ++v) {
    const Point<3> p = mesh.vertices.col(v);
    EXPECT_TRUE(tree.occluded(Point<3>::Zero(), p)) << "vertex " << v;
    if (std::hypot(p[0], p[1]) > 0.99) continue;
    EXPECT_TRUE(tree.occluded(Point<3>(p[0], p[1], 3), -Point<3>::UnitZ())) << "vertex " << v;
  }
  for (Index t = 0; t < mesh.triangles.cols(); ++t)
    EXPECT_TRUE(tree.occluded(Point<3>::Zero(),
                              mesh.vertices.col(mesh.triangles(0, t)) + mesh.vertices.col(mesh.triangles(1, t))));
}

TEST(TriangleTree, NothingIsFoundBeyondTheMaximalDistance) {
  const TriangleTree tree(unit_sphere(16));
  const Point<3> x(0, 0, 2);
  EXPECT_EQ(tree.closest(x, 0.999).triangle, -1);
  EXPECT_EQ(tree.closest(x, -2.0).triangle, -1);
  EXPECT_NEAR(tree.closest(x, 1.001).distance, 1, rounding);
}

TEST(TriangleTree, ScaleAndPositionDoNotChangeTheAnswers) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  const Mesh mesh = unit_sphere(20);
  const TriangleTree tree(mesh);
  for (const double scale : {0x1p-99, 0x1p99}) {
    Mesh scaled = mesh;
    scaled.vertices *= scale;
    const TriangleTree scaled_tree(scaled);
    for (int i = 0; i < 200; ++i) {
      const Point<3> x(normal(random), normal(random), normal(random));
      const Point<3> d(normal(random), normal(random), normal(random));
      const auto closest = tree.closest(x), scaled_closest = scaled_tree.closest(scale * x);
      EXPECT_EQ(closest.distance * scale, scaled_closest.distance);
      EXPECT_EQ(closest.triangle, scaled_closest.triangle);
      EXPECT_EQ(tree.first_hit(x, d).triangle, scaled_tree.first_hit(scale * x, scale * d).triangle);
    }
  }
}

TEST(TriangleTree, DistantQueriesAreExactToo) {
  const Mesh mesh = unit_sphere(20);
  const TriangleTree tree(mesh);
  const Point<3> towards = Point<3>(0.3, -0.2, 0.9).normalized();
  const double far = 1e8;
  const double far_rounding = 1e-7;  // of coordinates of size 1e8
  EXPECT_NEAR(tree.closest(far * towards).distance, brute_force_distance(mesh, far * towards), far_rounding);
  const auto hit = tree.first_hit(far * towards, -towards);
  ASSERT_GE(hit.triangle, 0);
  EXPECT_NEAR(hit.t, far - 2 + brute_force_hit(mesh, 2 * towards, -towards), far_rounding);
}

TEST(TriangleTree, DoesNotDependOnTheNumberOfThreads) {
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal;
  const Mesh mesh = triangle_soup(20000, random);
  set_thread_count(1);
  const TriangleTree serial(mesh);
  set_thread_count(3);
  const TriangleTree parallel(mesh);
  set_thread_count(0);
  for (int i = 0; i < 200; ++i) {
    const Point<3> x(normal(random), normal(random), normal(random));
    EXPECT_EQ(serial.closest(x).triangle, parallel.closest(x).triangle);
  }
}

TEST(TriangleTree, ManyCoincidingTrianglesDoNotExhaustTheTree) {
  Mesh mesh = right_triangle();
  mesh.triangles = mesh.triangles.replicate(1, 5000).eval();
  const TriangleTree tree(mesh);
  EXPECT_NEAR(tree.closest({0.5, 0.5, 3}).distance, 3, rounding);
  EXPECT_TRUE(tree.occluded({0.5, 0.5, 3}, {0, 0, -1}));
}

TEST(TriangleTree, AMeshOfOnePointIsAPoint) {
  Mesh mesh = right_triangle();
  mesh.vertices.setConstant(7);
  const TriangleTree tree(mesh);
  EXPECT_NEAR(tree.closest({7, 7, 9}).distance, 2, rounding);
  EXPECT_FALSE(tree.occluded({7, 7, 9}, {0, 0, -1}));
}

TEST(TriangleTree, RejectsMeshesThatAreEmptyOrCorrupt) {
  EXPECT_NE(invalid_input_message([] { TriangleTree{Mesh{}}; }).find("the mesh has no surface"), std::string::npos);
  Mesh wrong_index = right_triangle();
  wrong_index.triangles(1, 0) = 3;
  EXPECT_NE(invalid_input_message([&] { TriangleTree{wrong_index}; }).find("vertex index = 3"), std::string::npos);
  Mesh not_finite = right_triangle();
  not_finite.vertices(2, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(invalid_input_message([&] { TriangleTree{not_finite}; }).find("vertex = 1"), std::string::npos);
}

}  // namespace
}  // namespace csrbf::triangle_tree_test
