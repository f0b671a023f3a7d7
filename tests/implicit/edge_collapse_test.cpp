#include "csrbf/implicit/edge_collapse.hpp"

#include "mesh_testing.hpp"
#include "polygonize_fields.hpp"

namespace csrbf::polygonization {
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

}  // namespace
}  // namespace csrbf::polygonization
