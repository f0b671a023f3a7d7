#include "csrbf/implicit/mesh/mesh_distance.hpp"

#include "implicit/mesh_testing.hpp"
#include "implicit/polygonize_fields.hpp"

#include "csrbf/implicit/compare.hpp"
#include "csrbf/io/mesh.hpp"

#include <filesystem>

namespace csrbf::mesh_distance_test {
namespace {

// The cube [-1, 1]^3.
Mesh cube_mesh() {
  Mesh mesh;
  mesh.vertices.resize(3, 8);
  for (int c = 0; c < 8; ++c) mesh.vertices.col(c) << (c & 1) * 2 - 1, (c >> 1 & 1) * 2 - 1, (c >> 2) * 2 - 1;
  mesh.triangles.resize(3, 12);
  mesh.triangles << 0, 0, 1, 1, 0, 0, 2, 2, 0, 0, 4, 4,  //
      4, 6, 3, 7, 1, 5, 6, 7, 2, 3, 5, 7,                //
      6, 2, 7, 5, 5, 4, 7, 3, 3, 1, 7, 6;
  return mesh;
}

double cube_distance(const Point<3>& p) {
  const Point<3> q = p.cwiseAbs().array() - 1;
  return -q.cwiseMax(0).norm() - std::min(q.maxCoeff(), 0.0);
}

constexpr double rounding = 1e-14;

TEST(MeshDistance, IsTheDistanceToACubePositiveInside) {
  const MeshDistance field(cube_mesh());
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(-2, 2);
  for (int i = 0; i < 2000; ++i) {
    const Point<3> p(uniform(random), uniform(random), uniform(random));
    EXPECT_NEAR(field(p), cube_distance(p), rounding);
  }
  EXPECT_EQ(field.bounds().lo, Point<3>::Constant(-1));
  EXPECT_EQ(field.seeds().cols(), 1);
}

TEST(MeshDistance, GradientAndHessianAreThoseOfFacesEdgesAndVertices) {
  const MeshDistance field(cube_mesh());
  const Points<3> at = columns({{0.3, 0.2, 1.5}, {1.5, 0.2, 1.4}, {1.5, 1.4, 1.3}, {0.3, 0.2, 0.9}});
  const Jet<3> jet = field.evaluate(at, Derivatives::hessian);
  constexpr double step = 1e-5, error_of_differences = 1e-8;
  for (Index i = 0; i < at.cols(); ++i)
    for (Index axis = 0; axis < 3; ++axis) {
      const Point<3> up = at.col(i) + step * Point<3>::Unit(axis), down = at.col(i) - step * Point<3>::Unit(axis);
      EXPECT_NEAR(jet.gradient(axis, i), (field(up) - field(down)) / (2 * step), error_of_differences);
      const Point<3> bend = (field.evaluate(up, Derivatives::gradient).gradient.col(0) -
                             field.evaluate(down, Derivatives::gradient).gradient.col(0)) /
                            (2 * step);
      EXPECT_LT((jet.hessian_matrix(i).col(axis) - bend).norm(), error_of_differences);
    }
  const Jet<3> on_face = field.evaluate(columns({{0.3, 0.2, 1}}), Derivatives::gradient);
  EXPECT_NEAR(on_face.value[0], 0, rounding);
  EXPECT_LT((on_face.gradient.col(0) + Point<3>::UnitZ()).norm(), rounding);
}

TEST(MeshDistance, HasASeedOnEveryComponent) {
  Mesh two = cube_mesh();
  two.vertices.conservativeResize(3, 16);
  two.vertices.rightCols(8) = two.vertices.leftCols(8).colwise() + Point<3>(5, 0, 0);
  two.triangles.conservativeResize(3, 24);
  two.triangles.rightCols(12) = two.triangles.leftCols(12).array() + 8;
  const MeshDistance field(two);
  EXPECT_EQ(field.seeds().cols(), 2);
  EXPECT_EQ(topology(polygonize(field, {.resolution = 40})).components, 2);
}

TEST(MeshDistance, RefusesAnOpenMesh) {
  Mesh open = cube_mesh();
  open.triangles.conservativeResize(3, 11);
  EXPECT_NE(invalid_input_message([&] {
              (void)MeshDistance(open);
            }).find("MeshDistance: open or inconsistent edges = 3: must be none"),
            std::string::npos);
}

TEST(MeshDistance, IsPolygonizedWithItsEdgesByDualContouring) {
  const auto path = std::filesystem::path(__FILE__).parent_path() / "../../../shared/data/surface/fandisk.ply";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no mesh: " << path;
  const Mesh mesh = read_mesh(path.string());
  const MeshDistance field(mesh);
  const double cubes = compare(polygonize(field, {.resolution = 64}), mesh).hausdorff99;
  const Mesh dual = polygonize(field, {.resolution = 64, .method = PolygonizeMethod::dual_contouring});
  expect_closed_manifold(dual);
  EXPECT_LT(compare(dual, mesh).hausdorff99, cubes / 3);
}

}  // namespace
}  // namespace csrbf::mesh_distance_test
