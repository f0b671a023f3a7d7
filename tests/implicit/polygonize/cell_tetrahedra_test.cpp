#include "implicit/polygonize_fields.hpp"

#include <Eigen/Geometry>

#include <set>

namespace csrbf::cell_tetrahedra_test {
namespace {

PolygonizeOptions tetrahedra(PolygonizeOptions options) {
  options.method = PolygonizeMethod::marching_tetrahedra;
  return options;
}

// A vertex on every crossed edge along axes and diagonals.
TEST(CellTetrahedra, CutEveryCrossedEdgeOnce) {
  constexpr int n = 7;
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Implicit field = noise(n, seed);
    const auto inside = [&](const Eigen::Array3i& c) {
      return (c >= 0).all() && (c < n).all() && field(c.matrix().cast<double>()) >= 0;
    };
    Index edges = 0;
    for (int z = -1; z <= n; ++z)
      for (int y = -1; y <= n; ++y)
        for (int x = -1; x <= n; ++x)
          for (int d = 1; d < 8; ++d)
            edges += inside({x, y, z}) != inside({x + (d & 1), y + (d >> 1 & 1), z + (d >> 2)});
    const Mesh mesh = polygonize(field, tetrahedra(lattice_of_noise(n)));
    expect_closed_manifold(mesh);
    EXPECT_EQ(mesh.vertices.cols(), edges);
    EXPECT_GT(volume(mesh), 0);
  }
}

// All but the caps is on the plane, whichever way it goes through the cells.
TEST(CellTetrahedra, CutTheVolumeOffThatAPlaneDoes) {
  for (const Point<3>& n : {Point<3>(1, 2, 3), Point<3>(-2, 1, 1), Point<3>(1, -3, -1), Point<3>(-1, -1, -2)}) {
    const Implicit plane([&](const Point<3>& p, Point<3>& g) { return g = -n, -n.dot(p - off_center); }, cube(1));
    const Mesh mesh = polygonize(plane, tetrahedra({.resolution = 5, .bounds = cube(1)}));
    expect_closed_manifold(mesh);
    const double below = 4 + 4 * n.dot(off_center) / n.cwiseAbs().maxCoeff();  // of the cube, to first order
    EXPECT_NEAR(volume(mesh), below, 0.01 + 24 * edge_margin * 0.4);
    for (Index t = 0; t < mesh.triangles.cols(); ++t) {
      const Eigen::Vector3i v = mesh.triangles.col(t);
      const Point<3> a = mesh.vertices.col(v[0]);
      const Point<3> area = (mesh.vertices.col(v[1]) - a).cross(mesh.vertices.col(v[2]) - a);
      const bool on_plane = (mesh.normals(Eigen::all, v).colwise() - n.normalized()).norm() < 1e-9;
      EXPECT_LT(on_plane ? (area - n.normalized().dot(area) * n.normalized()).norm() : 0, 1e-12);
      EXPECT_GE(on_plane ? area.dot(n) : 0, -1e-12);  // outward
    }
  }
}

// Two triangles meet in the shorter diagonal of a quadrilateral.
TEST(CellTetrahedra, CutQuadrilateralsAlongTheShorterDiagonal) {
  const Mesh mesh = polygonize(sphere(1), tetrahedra({.resolution = 6}));
  const auto squared = [&](int a, int b) { return (mesh.vertices.col(a) - mesh.vertices.col(b)).squaredNorm(); };
  Index quadrilaterals = 0;
  for (Index t = 0; t + 1 < mesh.triangles.cols(); ++t) {
    const Eigen::Vector3i first = mesh.triangles.col(t), second = mesh.triangles.col(t + 1);
    const std::set<int> corners{first[0], first[1], first[2], second[0], second[1], second[2]};
    if (corners.size() != 4) continue;
    std::vector<int> common, others;
    for (const int v : corners)
      ((first.array() == v).any() && (second.array() == v).any() ? common : others).push_back(v);
    // Neighbours in other tetrahedra may follow each other too; those are joined by an edge of a face.
    quadrilaterals += squared(common[0], common[1]) <= squared(others[0], others[1]) * (1 + 1e-6);
  }
  EXPECT_GT(quadrilaterals, mesh.triangles.cols() / 4);
}

}  // namespace
}  // namespace csrbf::cell_tetrahedra_test
