#include "csrbf/implicit/mesh/edge_collapse.hpp"

#include "implicit/mesh_testing.hpp"
#include "implicit/polygonize_fields.hpp"

#include <Eigen/Geometry>

#include <random>

namespace csrbf::edge_collapse_test {
namespace {

Mesh tetrahedron() {
  Mesh mesh;
  mesh.vertices.resize(3, 4);
  mesh.vertices << 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1;
  mesh.triangles.resize(3, 4);
  mesh.triangles << 0, 0, 0, 1, 2, 1, 3, 2, 1, 3, 2, 3;
  return mesh;
}

TEST(EdgeCollapser, LeavesATetrahedronAsItIs) {
  Mesh mesh = tetrahedron();
  EXPECT_TRUE(topology(mesh).watertight());
  EdgeCollapser collapser(mesh);
  EXPECT_FALSE(collapser.collapse(0, 1, Point<3>(0.5, 0, 0)));
  EXPECT_EQ(collapser.neighbours(0).size(), 3U);
  EXPECT_EQ(collapser.finish().size(), 4U);
  EXPECT_EQ(mesh.triangles.cols(), 4);
}

TEST(EdgeCollapser, RemovesAVertexAndTwoTriangles) {
  Mesh mesh = unit_sphere(8);
  const Topology before = topology(mesh);
  EdgeCollapser collapser(mesh);
  const int v = collapser.neighbours(40).front();
  const Point<3> middle = 0.5 * (mesh.vertices.col(40) + mesh.vertices.col(v));
  ASSERT_TRUE(collapser.collapse(40, v, middle));
  EXPECT_TRUE(collapser.neighbours(v).empty());
  const std::vector<int> old_number = collapser.finish();
  expect_closed_manifold(mesh);
  EXPECT_EQ(topology(mesh).triangles, before.triangles - 2);
  EXPECT_EQ(mesh.vertices.cols(), before.vertices - 1);
  EXPECT_EQ(std::count(old_number.begin(), old_number.end(), v), 0);
}

TEST(EdgeCollapser, KeepsTheTopologyWhateverIsAsked) {
  Mesh mesh = polygonize(torus(1, 0.4), {.resolution = 12});
  EdgeCollapser collapser(mesh);
  Index collapsed = 0;
  for (int round = 0; round < 20; ++round)
    for (int u = 0; u < static_cast<int>(mesh.vertices.cols()); ++u) {
      const std::vector<int> around = collapser.neighbours(u);
      for (const int v : around)
        if (collapser.collapse(u, v, mesh.vertices.col(u))) {
          ++collapsed;
          break;
        }
    }
  EXPECT_GT(collapsed, 100);
  collapser.finish();
  expect_closed_manifold(mesh);
  EXPECT_EQ(topology(mesh).euler, 0);
}

TEST(EdgeCollapser, RefusesToFoldATriangleOver) {
  Mesh mesh = unit_sphere(8);
  EdgeCollapser collapser(mesh);
  const int v = collapser.neighbours(40).front();
  EXPECT_FALSE(collapser.collapse(40, v, -mesh.vertices.col(40)));
}

TEST(CollapseShortEdges, MergesVerticesThatCoincide) {
  Mesh mesh = unit_sphere(16);
  EdgeCollapser collapser(mesh);
  Index moved = 0;
  for (int v = 40; v < 400; v += 70, ++moved) mesh.vertices.col(v) = mesh.vertices.col(collapser.neighbours(v).front());
  const Topology before = topology(mesh);
  collapse_short_edges(1e-9, mesh);
  expect_closed_manifold(mesh);
  EXPECT_EQ(mesh.vertices.cols(), before.vertices - moved);
  EXPECT_EQ(mesh.triangles.cols(), before.triangles - 2 * moved);
}

// Every edge of a sphere, one at a time, whichever side of its two triangles it is.
TEST(CollapseShortEdges, FindsEveryEdge) {
  const Mesh sphere = unit_sphere(4);
  for (int u = 0; u < static_cast<int>(sphere.vertices.cols()); ++u) {
    Mesh copy = sphere;
    for (const int v : std::vector<int>(EdgeCollapser(copy).neighbours(u)))
      for (int side = 0; side < 3; ++side) {
        Mesh mesh = sphere;
        mesh.vertices.col(v) = mesh.vertices.col(u);
        for (auto triangle : mesh.triangles.colwise()) {
          if (!(triangle.array() == u).any() || !(triangle.array() == v).any()) continue;
          while (triangle[(side + 2) % 3] == u || triangle[(side + 2) % 3] == v)
            triangle = Eigen::Vector3i(triangle[1], triangle[2], triangle[0]);
        }
        collapse_short_edges(1e-9, mesh);
        EXPECT_EQ(mesh.vertices.cols(), sphere.vertices.cols() - 1);
        expect_closed_manifold(mesh);
      }
  }
}

TEST(CollapseShortEdges, LeavesLongerEdges) {
  Mesh mesh = unit_sphere(8);
  double shortest = std::numeric_limits<double>::infinity();
  for (Index t = 0; t < mesh.triangles.cols(); ++t)
    for (int c = 0; c < 3; ++c)
      shortest = std::min(
          shortest,
          (mesh.vertices.col(mesh.triangles(c, t)) - mesh.vertices.col(mesh.triangles((c + 1) % 3, t))).norm());
  const Index before = mesh.vertices.cols();
  collapse_short_edges(0.999 * shortest, mesh);
  EXPECT_EQ(mesh.vertices.cols(), before);
  collapse_short_edges(1.001 * shortest, mesh);
  EXPECT_LT(mesh.vertices.cols(), before);
}

// What a collapse does to the triangles that stay: the largest angle by which one turns, and the least roundness of
// those that would be needles, as twice the area over the square of the longest side.
struct Change {
  double turn = 0, needle = 1;
};

Change change_of(const Mesh& mesh, int u, int v, const Point<3>& p) {
  Change change;
  for (Index t = 0; t < mesh.triangles.cols(); ++t) {
    std::array<Point<3>, 3> before, after;
    int moved = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const int w = mesh.triangles(static_cast<Index>(c), t);
      before[c] = mesh.vertices.col(w);
      after[c] = w == u || w == v ? p : before[c];
      moved += w == u || w == v;
    }
    if (moved != 1) continue;
    const auto area = [](const std::array<Point<3>, 3>& q) { return Point<3>((q[1] - q[0]).cross(q[2] - q[0])); };
    const double longest =
        std::max({(after[0] - after[1]).norm(), (after[1] - after[2]).norm(), (after[2] - after[0]).norm()});
    change.needle = std::min(change.needle, area(after).norm() / (longest * longest));
    const double cosine = area(before).normalized().dot(area(after).normalized());
    change.turn = std::max(change.turn, std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / pi);
  }
  return change;
}

TEST(EdgeCollapser, TurnsNoTriangleByMoreThan80DegreesAndMakesNoNeedles) {
  const Mesh sphere = unit_sphere(6);  // all of its triangles are round
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal(0, 0.25);
  int accepted = 0, turned = 0, thin = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    Mesh mesh = sphere;
    EdgeCollapser collapser(mesh);
    const int u = 2 + trial % 50, v = collapser.neighbours(u)[trial / 50 % 4];
    if (v < 2) continue;  // a pole
    const Point<3> p = mesh.vertices.col(u) + Point<3>(normal(random), normal(random), normal(random));
    const Change change = change_of(mesh, u, v, p);
    if (std::abs(change.turn - 80) < 2 || std::abs(change.needle - 0.1) < 0.01) continue;  // about there
    const bool fine = change.turn < 80 && change.needle > 0.1;
    EXPECT_EQ(collapser.collapse(u, v, p), fine) << change.turn << " " << change.needle;
    EXPECT_EQ(mesh.vertices.col(u), fine ? p : Point<3>(sphere.vertices.col(u)));
    accepted += fine;
    turned += change.turn > 80 && change.needle > 0.1;
    thin += change.turn < 80 && change.needle < 0.1;
    if (trial % 40 != 0) continue;
    collapser.finish();
    expect_closed_manifold(mesh);
    EXPECT_EQ(mesh.normals.cols(), mesh.vertices.cols());
  }
  EXPECT_GT(accepted, 100);
  EXPECT_GT(turned, 100);
  EXPECT_GT(thin, 10);
}

}  // namespace
}  // namespace csrbf::edge_collapse_test
