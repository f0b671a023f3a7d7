#include "csrbf/surface/prepare/rows.hpp"

#include "csrbf/implicit/polygonize.hpp"
#include "csrbf/surface/reconstruct.hpp"
#include "surface/oriented_shapes.hpp"
#include "surface/surface_testing.hpp"

namespace csrbf::rows_test {
namespace {

// Points of a torus near slanting planes, so many spacings of `count` even points apart.
Points<3> torus_on_planes(Index count, double gap) {
  const Shape even = random_torus(count, 1);
  const double step = gap * even.spacing();
  const Point<3> across = Point<3>(1, 2, 3).normalized();
  const Points<3> many = random_torus(40 * count, 2).points;
  std::vector<Index> near;
  for (Index i = 0; i < many.cols() && std::ssize(near) < count; ++i) {
    const double place = across.dot(many.col(i)) / step;
    if (std::abs(place - std::round(place)) < 0.1 / gap) near.push_back(i);
  }
  return many(Eigen::all, near);
}

double least_distance(const Points<3>& points) {
  const KdTree<3> tree(points);
  double least = std::numeric_limits<double>::infinity();
  for (Index i = 0; i < points.cols(); ++i) {
    Index ids[2];
    double squared[2];
    tree.nearest(points.col(i), 2, ids, squared);
    least = std::min(least, std::sqrt(squared[1]));
  }
  return least;
}

std::vector<Index> rows_of(const Points<3>& points) {
  return all_but_crowded_rows(points, KdTree<3>(points));
}

TEST(CrowdedRows, AreThinnedToWhatIsBetweenThem) {
  const double spacing = random_torus(6000, 1).spacing();
  for (const double gap : {2.0, 4.0, 8.0}) {
    const Points<3> points = torus_on_planes(6000, gap);
    const std::vector<Index> kept = rows_of(points);
    EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end()));
    const double apart = least_distance(points(Eigen::all, kept)) / (gap * spacing);
    EXPECT_GT(apart, 0.05) << gap;
    EXPECT_LT(apart, 0.5) << gap;
  }
}

TEST(CrowdedRows, AreNotInEvenClouds) {
  EXPECT_EQ(rows_of(random_torus(3000, 3).points), std::vector<Index>{});
  EXPECT_EQ(rows_of(random_torus(3000, 3, 0.05).points), std::vector<Index>{});
  EXPECT_EQ(rows_of(random_box({1, 1, 0.05}, 0.05, 4).points), std::vector<Index>{});
}

TEST(CrowdedRows, AreNotThinnedWhereThereIsNothingBetweenThem) {
  Points<3> wire(3, 3000);
  for (Index i = 0; i < wire.cols(); ++i) {
    const double t = 2 * std::numbers::pi * quasi_random(i, 1)[0];
    wire.col(i) << std::cos(t), std::sin(t), 0.3 * std::cos(3 * t);
  }
  EXPECT_EQ(rows_of(wire), std::vector<Index>{});
}

TEST(CrowdedRows, OfATorusBecomeATorus) {
  const Reconstruction result = reconstruct({torus_on_planes(6000, 4), {}, {}});
  ASSERT_FALSE(result.report.warnings.empty());
  EXPECT_NE(result.report.warnings.back().find("rows of points"), std::string::npos);
  const Mesh mesh = polygonize(*result.field, {.resolution = 96});
  expect_closed(mesh, 1, 0);
  const double spacing = random_torus(6000, 1).spacing();
  for (Index v = 0; v < mesh.vertices.cols(); ++v)
    ASSERT_LT(std::abs(Torus().depth(mesh.vertices.col(v))), 2 * spacing);
}

}  // namespace
}  // namespace csrbf::rows_test
