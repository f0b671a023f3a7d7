#include "implicit/polygonize_fields.hpp"

namespace csrbf::dual_vertices_test {
namespace {

PolygonizeOptions dual(PolygonizeOptions options, bool adaptive = false) {
  options.method = adaptive ? PolygonizeMethod::adaptive : PolygonizeMethod::dual_contouring;
  return options;
}

TEST(DualVertices, HaveTheTopologyOfMarchingCubes) {
  constexpr int n = 7;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Implicit field = noise(n, seed, seed % 3 == 2);
    const Topology cubes = topology(polygonize(field, lattice_of_noise(n)));
    for (const bool adaptive : {false, true}) {
      const Mesh mesh = polygonize(field, dual(lattice_of_noise(n), adaptive));
      expect_closed_manifold(mesh);
      EXPECT_EQ(topology(mesh).euler, cubes.euler);
      EXPECT_EQ(topology(mesh).components, cubes.components);
      EXPECT_LT((mesh.normals.colwise().norm().array() - 1).abs().maxCoeff(), 1e-12);
    }
  }
}

// Planes of a box turned a little meet in its edges and corners, and nowhere further out than the caps.
TEST(DualVertices, AreWhereThePlanesMeet) {
  const Point<3> half(0.7, 0.5, 0.4);
  const Implicit box = turned_box(half);
  for (const bool adaptive : {false, true}) {
    const Mesh mesh = polygonize(box, dual({.resolution = 12}, adaptive));
    expect_closed_manifold(mesh);
    EXPECT_LT(box.evaluate(mesh.vertices).value.cwiseAbs().maxCoeff(), 1e-4);
    EXPECT_NEAR(volume(mesh), 8 * half.prod(), 1e-3);
  }
}

// Where a corner is in one cell but its planes are seen from the next, it is up to half a cell beyond the wall.
TEST(DualVertices, StayWithinHalfACellOfTheirCell) {
  // The tangent planes of a cap of a sphere much smaller than a cell meet far away.
  for (const double height : {0.02, 0.1, 0.3}) {
    const Implicit dome = sphere(1, Point<3>(0.013, 0.021, -1 + height));
    const Mesh mesh = polygonize(dome, dual({.resolution = 4, .bounds = {{-1.9, -1.9, -0.5}, {1.9, 1.9, 1.4}}}));
    expect_closed_manifold(mesh);
    const double cell = 1.9 / 2;
    EXPECT_LT(mesh.vertices.row(2).maxCoeff(), height + 0.5 * cell);
  }
}

TEST(MergeCells, LeavesAPlaneOfFewTrianglesWithinTheTolerance) {
  const Point<3> n = Point<3>(1, 2, 3).normalized();
  const Implicit plane([=](const Point<3>& p, Point<3>& g) { return g = -n, 0.1 - n.dot(p); }, cube(1));
  const Mesh fine = polygonize(plane, dual({.resolution = 16, .bounds = cube(1)}));
  const Mesh mesh = polygonize(plane, dual({.resolution = 16, .bounds = cube(1)}, true));
  expect_closed_manifold(mesh);
  EXPECT_LT(mesh.triangles.cols(), fine.triangles.cols() / 10);
  const double tolerance = 0.1 * 2 / 16;
  EXPECT_NEAR(volume(mesh), volume(fine), areas(fine).sum() * tolerance);
}

// Vertices in different halves of the largest cube are not merged, so a coarse mesh of a ball keeps its eight octants.
TEST(MergeCells, KeepsABallWithinTheTolerance) {
  std::vector<Index> triangles;
  for (const double tolerance : {1e-4, 1e-3, 1e-2}) {
    const Mesh mesh =
        polygonize(sphere(1), dual({.resolution = 24, .tolerance = tolerance / sphere(1).bounds().diagonal()}, true));
    expect_closed_manifold(mesh);
    EXPECT_EQ(topology(mesh).euler, 2);
    EXPECT_LT(largest_distance_to_sphere(mesh, 1, off_center), tolerance);
    EXPECT_NEAR(volume(mesh), 4 * pi / 3, 4 * pi * (1.5 * tolerance + 0.002));  // chords of a cell err by 0.002
    triangles.push_back(mesh.triangles.cols());
  }
  EXPECT_LT(triangles[1], triangles[0]);
  EXPECT_LT(triangles[2], triangles[1] / 2);
}

}  // namespace
}  // namespace csrbf::dual_vertices_test
