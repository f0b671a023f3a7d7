#include "csrbf/implicit/mesh/optimize_mesh.hpp"

#include "core/error_testing.hpp"
#include "csrbf/core/parallel.hpp"
#include "implicit/mesh_testing.hpp"
#include "implicit/polygonize_fields.hpp"

namespace csrbf::optimize_mesh_test {
namespace {

TEST(OptimizeMesh, MakesNeedlesRoundOnTheSurface) {
  const Implicit ring = torus(1, 0.4);
  const Mesh mesh = polygonize(ring, {.resolution = 40});
  const Mesh better = optimize_mesh(ring, mesh);
  EXPECT_LT(smallest_angle(mesh), 1);  // vertices of marching cubes may be close to a corner of the lattice
  EXPECT_GT(smallest_angle(better), 10);
  EXPECT_TRUE(better.triangles == mesh.triangles);
  expect_closed_manifold(better);
  EXPECT_LT(ring.evaluate(better.vertices).value.cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_GT(volume(better), volume(mesh));  // inscribed both, and this one fills the torus better
  EXPECT_LT(volume(better), 2 * pi * pi * 0.16);
  const Points<3> expected = -ring.evaluate(better.vertices, Derivatives::gradient).gradient.colwise().normalized();
  EXPECT_LT((better.normals - expected).colwise().norm().maxCoeff(), 1e-6);
}

TEST(OptimizeMesh, FollowsTheLevel) {
  const Mesh mesh = polygonize(sphere(1), {.resolution = 20, .level = -0.25});
  const Mesh better = optimize_mesh(sphere(1), mesh, {.level = -0.25});
  EXPECT_LT(largest_distance_to_sphere(better, std::sqrt(1.5), off_center), 1e-12);  // (1 - r^2) / 2 = -1/4
}

TEST(OptimizeMesh, LeavesSharpEdgesInPlace) {
  const Point<3> half(0.7, 0.5, 0.4);
  const Implicit box = turned_box(half);
  const Mesh mesh = polygonize(box, {.resolution = 33, .method = PolygonizeMethod::dual_contouring});
  const Mesh better = optimize_mesh(box, mesh);
  expect_closed_manifold(better);
  EXPECT_NEAR(volume(better), 8 * half.prod(), 1e-6);
}

TEST(OptimizeMesh, DoesNotDependOnScaleAndThreads) {
  const Mesh mesh = polygonize(sphere(1), {.resolution = 20});
  const Mesh better = optimize_mesh(sphere(1), mesh);
  set_thread_count(1);
  EXPECT_TRUE(identical(optimize_mesh(sphere(1), mesh), better));
  set_thread_count(0);
  constexpr double scale = 0x1p60;
  const Implicit large(
      [=](const Point<3>& p, Point<3>& g) {
        const double f = ball(p / scale, off_center, 1, g) * scale;
        return f;
      },
      cube(1.1 * scale));
  Mesh large_mesh = mesh;
  large_mesh.vertices *= scale;
  EXPECT_LT((optimize_mesh(large, large_mesh).vertices / scale - better.vertices).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(OptimizeMesh, RefusesWhatItCannotImprove) {
  const Implicit ball = sphere(1);
  const Mesh mesh = polygonize(ball, {.resolution = 8});
  const auto message = [&](const Mesh& given, const OptimizeMeshOptions& options) {
    return invalid_input_message([&] { (void)optimize_mesh(ball, given, options); });
  };
  EXPECT_EQ(message(mesh, {.iterations = 0}), "optimize_mesh: iterations = 0: must be at least 1");
  EXPECT_EQ(message(mesh, {.level = std::nan("")}), "optimize_mesh: level = nan: must be finite");
  EXPECT_NE(message(right_triangle(), {}).find("optimize_mesh: mesh = (not a closed manifold)"), std::string::npos);
  Mesh broken = mesh;
  broken.vertices(0, 0) = std::nan("");
  EXPECT_NE(message(broken, {}).find("optimize_mesh: mesh = (not finite)"), std::string::npos);
}

TEST(OptimizeMesh, ReportsAndCanBeCancelled) {
  const Mesh mesh = polygonize(sphere(1), {.resolution = 8});
  double last = -1;
  (void)optimize_mesh(sphere(1), mesh, {.progress = [&](std::string_view stage, double fraction) {
                        EXPECT_EQ(stage, "optimize");
                        EXPECT_GT(fraction, last);
                        last = fraction;
                        return true;
                      }});
  EXPECT_EQ(last, 1);
  EXPECT_THROW((void)optimize_mesh(sphere(1), mesh, {.progress = [](std::string_view, double) { return false; }}),
               Cancelled);
}

TEST(SmallestAngle, IsThatOfARightTriangle) {
  EXPECT_NEAR(smallest_angle(right_triangle()), 45, 1e-12);
}

}  // namespace
}  // namespace csrbf::optimize_mesh_test
