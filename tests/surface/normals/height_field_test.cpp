#include "csrbf/surface/normals/height_field.hpp"

#include "csrbf/surface/estimate_normals.hpp"
#include "surface/surface_testing.hpp"

namespace csrbf::height_field_test {
namespace {

double height(double x, double y) {
  return 0.08 * std::sin(7 * x + 5) * std::cos(6 * y + 5) + 0.03 * std::sin(19 * x + 5) * std::sin(17 * y);
}

// What a scanner beside the hills sees of points on them, but for grazing rays: patches between shadows.
Points<3> hills_from_the_side(Index count) {
  const Point<3> eye(2.2, 0.9, 0.45);
  Points<3> seen(3, count);
  Index n = 0;
  for (Index i = 0; i < count; ++i) {
    const Eigen::Vector2d p = quasi_random(i, 1);
    const Point<3> at(p[0], p[1], height(p[0], p[1])), ray = eye - at;
    constexpr double step = 1e-5;
    const Point<3> normal((at[2] - height(p[0] + step, p[1])) / step, (at[2] - height(p[0], p[1] + step)) / step, 1);
    bool visible = normal.dot(ray) > 0.1 * normal.norm() * ray.norm();
    for (double t = 0.01; t < 1 && visible; t += 0.002) {
      const Point<3> on_ray = at + t * ray;
      visible = on_ray.head<2>().maxCoeff() > 1 || on_ray[2] > height(on_ray[0], on_ray[1]);
    }
    if (visible) seen.col(n++) = at;
  }
  return seen.leftCols(n);
}

// Normals of any signs.
Points<3> random_signs(Points<3> normals) {
  std::mt19937_64 random(1);
  for (Index i = 0; i < normals.cols(); ++i)
    if (random() % 2 == 0) normals.col(i) = -normals.col(i).eval();
  return normals;
}

TEST(HeightField, PatchesBetweenShadowsHaveOneSide) {
  const Points<3> points = hills_from_the_side(20'000);
  ASSERT_GT(points.cols(), 8000);
  ASSERT_LT(points.cols(), 12'000);
  const Points<3> normals = estimate_normals(points);
  EXPECT_EQ((normals.row(2).array() <= 0).count(), 0);
}

TEST(HeightField, SheetsFaceUpwardAndBowlsOutward) {
  const PointCloud ball = sphere_cloud(8000);
  for (const double lowest : {0.98, 0.35}) {  // both below the cap's centre: z runs from there to 1
    std::vector<Index> cap;
    for (Index i = 0; i < ball.size(); ++i)
      if (ball.points(2, i) > lowest) cap.push_back(i);
    const Points<3> inside_out = ball.points(Eigen::all, cap).array().colwise() * Eigen::Array3d(1, 1, -1);
    Points<3> normals = random_signs(inside_out);
    ASSERT_TRUE(orient_height_field(inside_out, KdTree<3>(inside_out), normals));
    const double side = lowest > 0.9 ? -1 : 1;  // nearly flat: up, which is towards the centre; deep: away from it
    EXPECT_EQ(((normals.array() * inside_out.array()).colwise().sum() * side <= 0).count(), 0) << lowest;
  }
}

TEST(HeightField, SolidsAndLayersAreNone) {
  const PointCloud ball = sphere_cloud(3000);
  Points<3> normals = ball.normals;
  EXPECT_FALSE(orient_height_field(ball.points, KdTree<3>(ball.points), normals));
  Points<3> layers(3, 4000);
  for (Index i = 0; i < layers.cols(); ++i) layers.col(i) << quasi_random(i, 1), 0.3 * static_cast<double>(i % 2);
  Points<3> up = Point<3>::UnitZ().replicate(1, layers.cols());
  const Points<3> before = up;
  EXPECT_FALSE(orient_height_field(layers, KdTree<3>(layers), up));
  EXPECT_EQ(up, before);
}

}  // namespace
}  // namespace csrbf::height_field_test
