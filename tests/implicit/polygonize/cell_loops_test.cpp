#include "csrbf/implicit/polygonize/cell_loops.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace csrbf::polygonization::cell_loops_test {
namespace {

Point<3> corner_position(int corner) {
  return Point<3>(corner & 1, corner >> 1 & 1, corner >> 2);
}

Point<3> edge_midpoint(int edge) {
  const int lower = cell_edges[edge].corner;
  return 0.5 * (corner_position(lower) + corner_position(lower | 1 << cell_edges[edge].axis));
}

bool crossed(unsigned inside, int edge) {
  const int lower = cell_edges[edge].corner;
  return (inside >> lower & 1) != (inside >> (lower | 1 << cell_edges[edge].axis) & 1);
}

// Two points on the boundary of the unit cell lie on one face when a coordinate of both is the same 0 or 1.
bool on_one_face(const Point<3>& p, const Point<3>& q) {
  for (int axis = 0; axis < 3; ++axis)
    if (p[axis] == q[axis] && (p[axis] == 0 || p[axis] == 1)) return true;
  return false;
}

template <class Check>
void for_each_case(const Check& check) {
  for (unsigned inside = 0; inside < 256; ++inside)
    for (unsigned joined = 0; joined < 64; ++joined)
      if ((joined & ~ambiguous_faces(inside)) == 0) check(inside, joined);
}

TEST(CellLoops, OneInsideCornerGivesOneTriangleThatLooksAwayFromIt) {
  for (int corner = 0; corner < 8; ++corner) {
    const auto loops = cell_loops(1U << corner, 0);
    ASSERT_EQ(loops.size(), 1U);
    ASSERT_EQ(loops[0].size, 3);
    const Point<3> a = edge_midpoint(loops[0].edges[0]);
    const Point<3> u = edge_midpoint(loops[0].edges[1]) - a;
    const Point<3> v = edge_midpoint(loops[0].edges[2]) - a;
    const Point<3> normal(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]);
    EXPECT_GT(normal.dot(a - corner_position(corner)), 0);
  }
}

TEST(CellLoops, DeciderJoinsTheDiagonalWithTheLargerProduct) {
  const unsigned inside = 0b0000'1001;  // corners 0 and 3 of the face z = 0, face 4
  EXPECT_EQ(ambiguous_faces(inside), 1U << 4);
  EXPECT_EQ(joined_faces(inside, {2, -1, -1, 2, -1, -1, -1, -1}), 1U << 4);
  EXPECT_EQ(joined_faces(inside, {1, -2, -2, 1, -1, -1, -1, -1}), 0U);
  EXPECT_EQ(cell_loops(inside, 1U << 4).size(), 1U);
  EXPECT_EQ(cell_loops(inside, 0).size(), 2U);
}

TEST(CellLoops, EveryCrossedEdgeIsOnExactlyOneLoopInEveryCase) {
  for_each_case([](unsigned inside, unsigned joined) {
    std::multiset<int> passed;
    for (const CellLoop& loop : cell_loops(inside, joined))
      for (int i = 0; i < loop.size; ++i) passed.insert(loop.edges[i]);
    for (int edge = 0; edge < 12; ++edge) EXPECT_EQ(passed.count(edge), crossed(inside, edge) ? 1U : 0U) << inside;
  });
}

TEST(CellLoops, NeighboursCutTheirCommonFaceAlikeInOppositeDirections) {
  using Segment = std::pair<std::array<double, 2>, std::array<double, 2>>;
  const auto segments_on_face = [](unsigned inside, unsigned joined, int axis, int side) {
    std::set<Segment> segments;
    for (const CellLoop& loop : cell_loops(inside, joined)) {
      for (int i = 0; i < loop.size; ++i) {
        const Point<3> p = edge_midpoint(loop.edges[i]);
        const Point<3> q = edge_midpoint(loop.edges[(i + 1) % loop.size]);
        if (p[axis] != side || q[axis] != side) continue;
        const int b = (axis + 1) % 3;
        const int c = (axis + 2) % 3;
        segments.insert(side == 1 ? Segment{{p[b], p[c]}, {q[b], q[c]}} : Segment{{q[b], q[c]}, {p[b], p[c]}});
      }
    }
    return segments;
  };
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int trial = 0; trial < 3000; ++trial) {
    std::array<double, 12> value;  // two cells along `axis`: corners with coordinate 0, 1, 2 there
    for (double& v : value) v = uniform(random);
    const int axis = trial % 3;
    std::array<std::array<double, 8>, 2> cell;
    std::array<unsigned, 2> inside{};
    for (int side = 0; side < 2; ++side) {
      for (int c = 0; c < 8; ++c) {
        const int layer = (c >> axis & 1) + side;
        const int in_layer = (c >> ((axis + 1) % 3) & 1) + 2 * (c >> ((axis + 2) % 3) & 1);
        cell[side][c] = value[layer * 4 + in_layer];
        inside[side] |= static_cast<unsigned>(cell[side][c] >= 0) << c;
      }
    }
    EXPECT_EQ(segments_on_face(inside[0], joined_faces(inside[0], cell[0]), axis, 1),
              segments_on_face(inside[1], joined_faces(inside[1], cell[1]), axis, 0));
  }
}

TEST(CellLoops, NoTriangulationJoinsTwoVerticesOfOneFaceOffTheLoop) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> uniform(0.1, 0.9);
  std::array<LoopTriangle, 12> triangles;
  for_each_case([&](unsigned inside, unsigned joined) {
    for (const CellLoop& loop : cell_loops(inside, joined)) {
      if (!loop.triangulable) continue;
      std::array<Point<3>, 12> points;
      for (int i = 0; i < loop.size; ++i) {
        points[i] = edge_midpoint(loop.edges[i]);
        points[i][cell_edges[loop.edges[i]].axis] = uniform(random);
      }
      triangulate(loop, points, triangles);
      std::multiset<std::pair<int, int>> edges;
      for (int t = 0; t < loop.triangles(); ++t)
        for (int i = 0; i < 3; ++i) edges.emplace(triangles[t][i], triangles[t][(i + 1) % 3]);
      for (const auto& [i, j] : edges) {
        EXPECT_EQ(edges.count({i, j}), 1U);
        if (j == (i + 1) % loop.size) continue;
        EXPECT_EQ(edges.count({j, i}), 1U);
        EXPECT_FALSE(on_one_face(points[i], points[j]));
      }
    }
  });
}

TEST(CellLoops, QuadrilateralsAreSplitByTheShorterDiagonal) {
  const unsigned inside = 0b0000'1111;  // the lower half: a loop over the four edges along z
  const CellLoop& loop = cell_loops(inside, 0)[0];
  ASSERT_EQ(loop.size, 4);
  std::array<Point<3>, 12> points;
  for (int i = 0; i < 4; ++i) points[i] = edge_midpoint(loop.edges[i]);
  std::array<LoopTriangle, 12> triangles;
  points[1][2] = 0.9;
  points[3][2] = 0.1;
  triangulate(loop, points, triangles);
  EXPECT_EQ(triangles[0], (LoopTriangle{0, 1, 2}));
  std::swap(points[0][2], points[1][2]);
  std::swap(points[2][2], points[3][2]);
  triangulate(loop, points, triangles);
  EXPECT_EQ(triangles[0], (LoopTriangle{0, 1, 3}));
}

}  // namespace
}  // namespace csrbf::polygonization::cell_loops_test
