#include "csrbf/core/mesh.hpp"

#include "csrbf/core/error.hpp"

#include "core/topology_testing.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>

namespace csrbf::mesh_test {
namespace {

using Faces = std::vector<std::array<int, 3>>;

Mesh make_mesh(Index vertices, const Faces& faces) {
  Mesh mesh;
  mesh.vertices = Points<3>::Zero(3, vertices);
  mesh.triangles.resize(3, static_cast<Index>(faces.size()));
  for (std::size_t t = 0; t < faces.size(); ++t)
    mesh.triangles.col(static_cast<Index>(t)) << faces[t][0], faces[t][1], faces[t][2];
  return mesh;
}

// Surface of a tetrahedron over vertices first ... first + 3.
Faces tetrahedron(int first = 0) {
  Faces faces{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  for (auto& face : faces)
    for (int& v : face) v += first;
  return faces;
}

Faces operator+(Faces a, const Faces& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

// n x m quadrilaterals with opposite sides identified.
Mesh torus_grid(int n, int m) {
  Faces faces;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < m; ++j) {
      const int a = i * m + j;
      const int b = (i + 1) % n * m + j;
      const int c = (i + 1) % n * m + (j + 1) % m;
      const int d = i * m + (j + 1) % m;
      faces.push_back({a, b, c});
      faces.push_back({a, c, d});
    }
  }
  return make_mesh(n * m, faces);
}

// The definition, straight from maps of edges and links of vertices.
Topology brute_force(const Mesh& mesh) {
  Topology result;
  std::map<std::pair<int, int>, std::vector<int>> edges;  // +1 or -1 per triangle by direction
  std::map<int, std::vector<std::pair<int, int>>> links;
  for (Index t = 0; t < mesh.triangles.cols(); ++t) {
    const Eigen::Vector3i v = mesh.triangles.col(t);
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) continue;
    ++result.triangles;
    for (int i = 0; i < 3; ++i) {
      const int a = v[i];
      const int b = v[(i + 1) % 3];
      edges[std::minmax(a, b)].push_back(a < b ? 1 : -1);
      links[v[i]].emplace_back(v[(i + 1) % 3], v[(i + 2) % 3]);
    }
  }
  result.vertices = static_cast<Index>(links.size());
  result.edges = static_cast<Index>(edges.size());
  for (const auto& [edge, sides] : edges) {
    if (sides.size() == 1) ++result.boundary_edges;
    if (sides.size() > 2) ++result.nonmanifold_edges;
    if (sides.size() == 2 && sides[0] == sides[1]) ++result.inconsistent_edges;
  }
  std::map<int, int> component;
  for (const auto& [v, link] : links) component[v] = v;
  for (bool changed = true; changed;) {
    changed = false;
    for (const auto& [edge, sides] : edges) {
      int& a = component[edge.first];
      int& b = component[edge.second];
      if (a == b) continue;
      a = b = std::min(a, b);
      changed = true;
    }
  }
  std::set<int> labels;
  for (const auto& [v, label] : component) labels.insert(label);
  result.components = static_cast<Index>(labels.size());
  for (const auto& [v, link] : links) {
    std::map<int, std::set<int>> sides;  // neighbour -> triangles
    for (int i = 0; i < static_cast<int>(link.size()); ++i) {
      sides[link[i].first].insert(i);
      sides[link[i].second].insert(i);
    }
    bool regular = true;
    for (const auto& [w, triangles] : sides) regular = regular && triangles.size() <= 2;
    std::set<int> reached{0};
    for (bool changed = true; changed;) {
      const std::size_t before = reached.size();
      for (const auto& [w, triangles] : sides)
        for (int t : triangles)
          if (reached.count(t)) reached.insert(triangles.begin(), triangles.end());
      changed = reached.size() > before;
    }
    if (!regular || reached.size() < link.size()) ++result.nonmanifold_vertices;
  }
  result.euler = result.vertices - result.edges + result.triangles;
  return result;
}

TEST(Topology, TetrahedronIsAClosedManifoldSphere) {
  const Topology t = topology(make_mesh(4, tetrahedron()));
  EXPECT_EQ(t.vertices, 4);
  EXPECT_EQ(t.edges, 6);
  EXPECT_EQ(t.triangles, 4);
  EXPECT_EQ(t.euler, 2);
  EXPECT_EQ(t.components, 1);
  EXPECT_TRUE(t.watertight());
  EXPECT_TRUE(t.manifold());
}

TEST(Topology, TorusHasEulerNumberZero) {
  const Topology t = topology(torus_grid(7, 5));
  EXPECT_EQ(t.euler, 0);
  EXPECT_EQ(t.components, 1);
  EXPECT_TRUE(t.watertight());
  EXPECT_TRUE(t.manifold());
}

TEST(Topology, MissingTriangleLeavesThreeBoundaryEdgesOfAManifold) {
  Faces faces = tetrahedron();
  faces.pop_back();
  const Topology t = topology(make_mesh(4, faces));
  EXPECT_EQ(t.boundary_edges, 3);
  EXPECT_FALSE(t.watertight());
  EXPECT_TRUE(t.manifold());
}

TEST(Topology, FlippedTriangleMakesItsEdgesInconsistent) {
  Faces faces = tetrahedron();
  std::swap(faces[0][0], faces[0][1]);
  const Topology t = topology(make_mesh(4, faces));
  EXPECT_EQ(t.inconsistent_edges, 3);
  EXPECT_FALSE(t.watertight());
}

TEST(Topology, SolidsThatTouchInAVertexAreWatertightButNotManifold) {
  Faces second = tetrahedron(3);  // shares vertex 3
  const Topology t = topology(make_mesh(7, tetrahedron() + second));
  EXPECT_TRUE(t.watertight());
  EXPECT_EQ(t.nonmanifold_vertices, 1);
  EXPECT_EQ(t.components, 1);
  EXPECT_FALSE(t.manifold());
}

TEST(Topology, SolidsThatTouchInAnEdgeHaveANonmanifoldEdge) {
  Faces second = tetrahedron(4);
  for (auto& face : second)
    for (int& v : face) v = v == 4 ? 0 : v == 5 ? 1 : v;
  const Topology t = topology(make_mesh(8, tetrahedron() + second));
  EXPECT_EQ(t.nonmanifold_edges, 1);
  EXPECT_EQ(t.nonmanifold_vertices, 2);
  EXPECT_FALSE(t.watertight());
}

TEST(Topology, UnusedVerticesAndTrianglesWithARepeatedVertexDoNotCount) {
  const Topology t = topology(make_mesh(9, tetrahedron() + Faces{{7, 7, 8}}));
  EXPECT_EQ(t.vertices, 4);
  EXPECT_EQ(t.triangles, 4);
  EXPECT_TRUE(t.watertight());
}

TEST(Topology, EmptyMeshHasNothingAndIsNotWatertight) {
  const Topology t = topology(Mesh{});
  EXPECT_EQ(t.vertices + t.edges + t.triangles + t.components, 0);
  EXPECT_FALSE(t.watertight());
}

TEST(Topology, AgreesWithTheDefinitionOnRandomTriangles) {
  std::mt19937_64 random(3);
  for (int trial = 0; trial < 300; ++trial) {
    const int vertices = 4 + trial % 9;
    std::uniform_int_distribution<int> vertex(0, vertices - 1);
    Faces faces;
    for (int t = 0; t < trial % 23; ++t) faces.push_back({vertex(random), vertex(random), vertex(random)});
    const Mesh mesh = make_mesh(vertices, faces);
    expect_equal(topology(mesh), brute_force(mesh));
  }
}

TEST(Topology, DoesNotDependOnTheNumberingOfVerticesAndTriangles) {
  std::mt19937_64 random(4);
  const Mesh mesh = torus_grid(9, 6);
  Eigen::PermutationMatrix<Eigen::Dynamic> order(mesh.triangles.cols());
  order.setIdentity();
  std::shuffle(order.indices().data(), order.indices().data() + order.size(), random);
  std::vector<int> name(54);
  for (int i = 0; i < 54; ++i) name[i] = i;
  std::shuffle(name.begin(), name.end(), random);
  Mesh shuffled = mesh;
  shuffled.triangles = mesh.triangles * order;
  for (Index i = 0; i < shuffled.triangles.size(); ++i) shuffled.triangles(i) = name[shuffled.triangles(i)];
  expect_equal(topology(shuffled), topology(mesh));
}

TEST(Topology, RefusesAnIndexWithoutVertex) {
  for (const int bad : {-1, 4}) {
    try {
      (void)topology(make_mesh(4, {{0, 1, bad}}));
      FAIL() << "no error";
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find("topology: vertex index"), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace csrbf::mesh_test
