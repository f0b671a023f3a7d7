#include "csrbf/implicit/polygonize/dual_triangles.hpp"

#include "csrbf/implicit/mesh/triangle_geometry.hpp"
#include "implicit/polygonize_fields.hpp"

#include <set>

namespace csrbf::polygonization::dual_triangles_test {
namespace {

constexpr double rounding = 1e-12;

struct Surface {
  DualSurface dual;
  Mesh crossings, mesh;
};

// One quad seen from above, and the point of the surface in it.
Surface quad(const std::array<Point<3>, 4>& corners, const Point<3>& crossing) {
  Surface s;
  s.dual.quads.resize(4, 1);
  s.dual.quads << 0, 1, 2, 3;
  s.crossings.vertices = crossing;
  s.crossings.normals = Point<3>::UnitZ();
  s.mesh.vertices.resize(3, 4);
  for (int i = 0; i < 4; ++i) s.mesh.vertices.col(i) = corners[i];
  return s;
}

// Is a quad cut from its first corner to its third? Says the same when the corners are counted from the next one.
bool first_diagonal_is_cut(const std::array<Point<3>, 4>& corners, const Point<3>& crossing) {
  bool first = false;
  for (int turn = 0; turn < 4; ++turn) {
    std::array<Point<3>, 4> turned;
    for (std::size_t i = 0; i < 4; ++i) turned[i] = corners[(i + static_cast<std::size_t>(turn)) % 4];
    Surface s = quad(turned, crossing);
    triangulate_quads(s.dual, s.crossings, s.mesh);
    Eigen::Matrix<int, 3, 2> from_0, from_1;
    from_0 << 0, 0, 1, 2, 2, 3;
    from_1 << 0, 1, 1, 2, 3, 3;
    const bool cut = s.mesh.triangles == from_0;
    EXPECT_TRUE(cut || s.mesh.triangles == from_1);
    if (turn == 0) first = cut;
    EXPECT_EQ(cut, (turn % 2 == 0) == first);
  }
  return first;
}

TEST(TriangulateQuads, CutsAlongTheShorterDiagonal) {
  const Point<3> middle(0, 0, 0);
  EXPECT_TRUE(first_diagonal_is_cut({Point<3>(-1, 0, 0), {0, -1.01, 0}, {1, 0, 0}, {0, 1.01, 0}}, middle));
  EXPECT_FALSE(first_diagonal_is_cut({Point<3>(-1.01, 0, 0), {0, -1, 0}, {1.01, 0, 0}, {0, 1, 0}}, middle));
}

TEST(TriangulateQuads, CutsTheFirstDiagonalOfASquare) {
  Surface s = quad({Point<3>(0, 0, 0), {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {0.5, 0.5, 0});
  triangulate_quads(s.dual, s.crossings, s.mesh);
  EXPECT_TRUE(s.mesh.triangles.col(0) == Eigen::Vector3i(0, 1, 2));
}

// Corner 1 lies within the triangle of the others: the diagonal that avoids it has a triangle the wrong way round.
TEST(TriangulateQuads, FoldsNoTriangleThoughTheDiagonalIsLonger) {
  const std::array<Point<3>, 4> arrow{Point<3>(-1, 0, 0), Point<3>(0, 0.3, 0), Point<3>(1, 0, 0), Point<3>(0, 3, 0)};
  EXPECT_FALSE(first_diagonal_is_cut(arrow, {0, 1, 0}));
}

// Over a saddle one diagonal is above the other.
TEST(TriangulateQuads, ComesClosestToTheCrossingThoughTheDiagonalIsLonger) {
  const std::array<Point<3>, 4> saddle{Point<3>(-1.2, 0, 0.2), {0, -1, -0.2}, {1.2, 0, 0.2}, {0, 1, -0.2}};
  EXPECT_TRUE(first_diagonal_is_cut(saddle, {0, 0, 0.1}));
  EXPECT_TRUE(first_diagonal_is_cut(saddle, {0, 0, 0.01}));
  EXPECT_FALSE(first_diagonal_is_cut(saddle, {0, 0, -0.01}));
}

// A row of squares; sides of some have vertices that stand out, so that all polygons are strictly convex.
TEST(TriangulateQuads, TakesInTheVerticesOnSides) {
  constexpr int n = 4;
  Surface s;
  s.dual.quads.resize(4, n);
  s.mesh.vertices.resize(3, 4 * n + 5);
  s.crossings.vertices.resize(3, n);
  s.crossings.normals = Point<3>::UnitZ().replicate(1, n);
  const std::array<Point<3>, 4> square{Point<3>(0, 0, 0), {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  for (int e = 0; e < n; ++e) {
    for (int i = 0; i < 4; ++i) {
      s.dual.quads(i, e) = 4 * e + i;
      s.mesh.vertices.col(4 * e + i) = square[i] + Point<3>(3 * e, 0, 0);
    }
    s.crossings.vertices.col(e) = Point<3>(3 * e + 0.5, 0.5, 0);
  }
  const int v = 4 * n;
  s.mesh.vertices.rightCols(5) << 3.5, 4.1, 9.5, 8.9, 9.6,  //
      -0.1, 0.4, -0.1, 0.3, 1.2,                            //
      0, 0, 0, 0, 0;
  s.dual.side_vertices = {{1, 0, v}, {1, 1, v + 1}, {3, 0, v + 2}, {3, 2, v + 4}, {3, 3, v + 3}};
  const std::vector<std::vector<int>> polygons{
      {0, 1, 2, 3}, {4, v, 5, v + 1, 6, 7}, {8, 9, 10, 11}, {12, v + 2, 13, 14, v + 4, 15, v + 3}};
  triangulate_quads(s.dual, s.crossings, s.mesh);
  ASSERT_EQ(s.mesh.triangles.cols(), 2 * n + 5);
  std::array<int, n> triangles{};
  std::array<double, n> area{};
  std::multiset<std::pair<int, int>> edges;
  for (Index t = 0; t < s.mesh.triangles.cols(); ++t) {
    const Eigen::Vector3i c = s.mesh.triangles.col(t);
    int e = -1;
    for (int p = 0; p < n; ++p) {
      const auto& polygon = polygons[p];
      if (std::all_of(c.begin(), c.end(), [&](int w) { return std::count(polygon.begin(), polygon.end(), w) == 1; }))
        e = p;
    }
    ASSERT_GE(e, 0);
    if (t < 2 * n) {
      EXPECT_EQ(e, t / 2);
    }
    ++triangles[e];
    const double z =
        area_vector(s.mesh.vertices.col(c[0]), s.mesh.vertices.col(c[1]), s.mesh.vertices.col(c[2]))[2] / 2;
    EXPECT_GT(z, 0);
    area[e] += z;
    for (int i = 0; i < 3; ++i) edges.emplace(c[i], c[(i + 1) % 3]);
  }
  for (std::size_t e = 0; e < n; ++e) {
    const auto& polygon = polygons[e];
    EXPECT_EQ(triangles[e], static_cast<int>(polygon.size()) - 2);
    double expected = 0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const int a = polygon[i], b = polygon[(i + 1) % polygon.size()], c = polygon[(i + 2) % polygon.size()];
      EXPECT_EQ(edges.count({a, b}), 1U);
      expected += 0.5 * area_vector(Point<3>::Zero(), s.mesh.vertices.col(a), s.mesh.vertices.col(b))[2];
      if (b >= v) {  // the corners next to a vertex on a side are not joined
        EXPECT_EQ(edges.count({a, c}) + edges.count({c, a}), 0U);
      }
    }
    EXPECT_NEAR(area[e], expected, rounding);
  }
}

// Three by three squares of side 1 in a plane; vertex 5, the lower left inner one, is at p.
Surface grid(const Point<3>& p, bool loose) {
  Surface s;
  s.mesh.vertices.resize(3, 16);
  for (int i = 0; i < 16; ++i) s.mesh.vertices.col(i) = Point<3>(i % 4, i / 4, 0);
  s.dual.quads.resize(4, 9);
  s.crossings.vertices.resize(3, 9);
  for (int e = 0; e < 9; ++e) {
    const int first = e % 3 + 4 * (e / 3);
    s.dual.quads.col(e) << first, first + 1, first + 5, first + 4;
    s.crossings.vertices.col(e) = s.mesh.vertices.col(first) + Point<3>(0.5, 0.5, 0);
  }
  s.crossings.normals = Point<3>::UnitZ().replicate(1, 9);
  s.mesh.normals = Point<3>::UnitZ().replicate(1, 16);
  s.dual.loose.assign(16, 0);
  s.dual.loose[5] = loose;
  s.mesh.vertices.col(5) = p;
  return s;
}

TEST(UnfoldQuads, DrawsLooseVerticesOfFoldedTrianglesToTheMeanOfTheirCrossings) {
  const Point<3> mean(1, 1, 0);
  const auto moved = [](const Point<3>& p, bool loose) {
    Surface s = grid(p, loose);
    const Points<3> before = s.mesh.vertices;
    unfold_quads(s.dual, s.crossings, s.mesh);
    for (int i = 0; i < 16; ++i) {
      if (i == 5) continue;
      EXPECT_EQ(s.mesh.vertices.col(i), before.col(i));
    }
    return Point<3>(s.mesh.vertices.col(5));
  };
  const Point<3> fine(1.2, 0.7, 0.1), near(-0.5, 0.9, 0), far(2.9, 2.9, 0), farther(-9, -7, 0);
  EXPECT_EQ(moved(fine, true), fine);
  EXPECT_EQ(moved(near, false), near);
  EXPECT_LT((moved(near, true) - 0.5 * (near + mean)).norm(), rounding);  // no longer folded
  EXPECT_LT((moved(far, true) - (mean + 0.25 * (far - mean))).norm(), 0.25 * (far - mean).norm() + rounding);
  EXPECT_LT((moved(farther, true) - mean).norm(), rounding);  // after three rounds
}

}  // namespace
}  // namespace csrbf::polygonization::dual_triangles_test
