#include "csrbf/implicit/polygonize/edge_vertices.hpp"

#include "csrbf/implicit/polygonize/cell_tracer.hpp"
#include "implicit/polygonize_fields.hpp"

namespace csrbf::polygonization::edge_vertices_test {
namespace {

constexpr double rounding = 1e-12;  // of positions of size 1

// All crossed edges of a lattice around the origin, with their vertices.
struct Vertices {
  Vertices(const Field<3>& field, const CellLattice& given_lattice, const VertexDemand& demand,
           std::span<const int> directions = all_directions)
      : lattice(given_lattice), sampler(field, 0), tracer(lattice, sampler) {
    for (int z = 0; z < lattice.cells[2]; ++z)
      for (int y = 0; y < lattice.cells[1]; ++y)
        for (int x = 0; x < lattice.cells[0]; ++x) tracer.add({x, y, z});
    tracer.run({});
    bricks = tracer.finish(directions);
    mesh.vertices.setConstant(3, number_edge_vertices(bricks), std::numeric_limits<double>::quiet_NaN());
    if (demand.normals) mesh.normals = mesh.vertices;
    const Index traced = sampler.value_count();
    place_edge_vertices(lattice, bricks, sampler, demand, mesh, {});
    evaluations = sampler.value_count() - traced + sampler.gradient_count();
  }

  // visit(vertex, lower corner, direction) for each, in order.
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (const Brick* brick : bricks)
      for (int bit = 0; bit < 64; ++bit)
        for (const int d : all_directions)
          if (brick->edges[d] >> bit & 1) visit(edge_vertex({*brick, bit}, d), brick->corner(bit), d);
  }
  // Place along its edge, from 0 to 1; and how far it is off the edge.
  [[nodiscard]] std::pair<double, double> place(int vertex, const Cell& lower, int d) const {
    const Point<3> from = lattice.position(lower), edge = lattice.position(lower + offset(d)) - from;
    const Point<3> along = mesh.vertices.col(vertex) - from;
    const double t = along.dot(edge) / edge.squaredNorm();
    return {t, (along - t * edge).norm()};
  }
  [[nodiscard]] bool on_cap(const Cell& lower, int d) const {
    return lattice.on_boundary(lower) || lattice.on_boundary(lower + offset(d));
  }

  CellLattice lattice;
  LevelSampler sampler;
  CellTracer tracer;
  std::vector<Brick*> bricks;
  Mesh mesh;
  Index evaluations = 0;
};

CellLattice lattice_around(const Point<3>& center, double half, int cells) {
  const Point<3> spacing = Point<3>(2, 2.2, 2.4) * half / cells;
  return {center - 0.5 * cells * spacing, spacing, Cell::Constant(cells)};
}

// Where f = r^2 - |p|^2 is zero on the segment from a to b with one zero between them.
double root_on_segment(const Point<3>& a, const Point<3>& b, double radius) {
  const double A = (b - a).squaredNorm(), B = a.dot(b - a), C = a.squaredNorm() - radius * radius;
  const double root = std::sqrt(B * B - A * C);
  const double first = (-B - root) / A;
  return first >= 0 && first <= 1 ? first : (-B + root) / A;
}

TEST(EdgeVertices, AreNumberedInTheOrderOfBricksDirectionsAndCorners) {
  const Vertices ball(sphere(1), lattice_around(off_center, 1.3, 13), {});
  int next = 0;
  for (const Brick* brick : ball.bricks)
    for (const int d : all_directions)
      for (int bit = 0; bit < 64; ++bit)
        if (brick->edges[d] >> bit & 1) {
          EXPECT_EQ(edge_vertex({*brick, bit}, d), next++);
        }
  EXPECT_EQ(ball.mesh.vertices.cols(), next);
}

// The parabola through a value, a slope and another value is the field itself.
TEST(EdgeVertices, AreExactForQuadraticFields) {
  const Point<3> center = Point<3>::Zero();
  for (const bool normals : {true, false}) {
    const Vertices ball(sphere(1, center), lattice_around(off_center, 1.3, 17), {.normals = normals});
    Index inner = 0;
    ball.for_each([&](int vertex, const Cell& lower, int d) {
      const double root = root_on_segment(ball.lattice.position(lower), ball.lattice.position(lower + offset(d)), 1);
      EXPECT_NEAR(ball.mesh.vertices.col(vertex).norm(), 1, 1e-5);
      if (std::min(root, 1 - root) < edge_margin) return;
      ++inner;
      const auto [t, off] = ball.place(vertex, lower, d);
      EXPECT_NEAR(t, root, rounding);
      EXPECT_LT(off, rounding);
    });
    EXPECT_GT(inner, 1000);
  }
}

// Where Newton's step from the chord agrees with the parabola's, once is enough; no field needs more than a second look
// here, which confirms that the first step went home.
TEST(EdgeVertices, TakeOneEvaluationWhereTheSurfaceIsNearlyFlat) {
  const Implicit large = sphere(20, Point<3>(0, 0, -20));
  const Vertices cap(large, lattice_around(off_center, 0.5, 16), {});
  Index inner = 0, sampled = 0;
  cap.for_each([&](int vertex, const Cell& lower, int d) {
    if (cap.on_cap(lower, d)) return;
    const auto [t, off] = cap.place(vertex, lower, d);
    ++sampled;
    inner += t > edge_margin && t < 1 - edge_margin;
  });
  EXPECT_GT(inner, 500);
  EXPECT_EQ(cap.evaluations, sampled + (sampled - inner));
}

// A cubic with an inflection on the surface.
TEST(EdgeVertices, FindZerosOfFieldsThatBendBothWays) {
  const Implicit cubic(
      [=](const Point<3>& p, Point<3>& g) {
        const double z = p[2] - 0.31 - 0.2 * p[0];
        g = (3 * 40 * z * z + 1) * Point<3>(-0.2, 0, 1);
        return 40 * z * z * z + z;
      },
      cube(1));
  for (const bool normals : {true, false}) {
    const Vertices wall(cubic, lattice_around(off_center, 1, 11), {.normals = normals});
    wall.for_each([&](int vertex, const Cell& lower, int d) {
      if (wall.on_cap(lower, d)) return;
      const Point<3> p = wall.mesh.vertices.col(vertex);
      // Estimates are taken when they agree to 1e-4 of an edge, of length up to 0.35; they err by a few times that.
      EXPECT_NEAR(p[2], 0.31 + 0.2 * p[0], 5e-4 * 0.35);
    });
  }
}

// Estimates know nothing of a jump, so that nearly each of the twelve evaluations halves the bracket.
TEST(EdgeVertices, FindJumpsByHalving) {
  const Point<3> n = Point<3>(1, 2, 3).normalized();
  for (const bool normals : {true, false}) {
    const Implicit jump([=](const Point<3>& p, Point<3>& g) { return g.setZero(), n.dot(p) < 0.1234 ? 1.0 : -1.0; },
                        cube(1));
    const Vertices wall(jump, lattice_around(off_center, 1, 9), {.normals = normals});
    wall.for_each([&](int vertex, const Cell& lower, int d) {
      if (wall.on_cap(lower, d)) return;
      const Point<3> a = wall.lattice.position(lower), b = wall.lattice.position(lower + offset(d));
      const double root = (0.1234 - n.dot(a)) / n.dot(b - a);
      const auto [t, off] = wall.place(vertex, lower, d);
      EXPECT_NEAR(t, std::clamp(root, edge_margin, 1 - edge_margin), std::ldexp(1, -10));
      if (!normals) return;
      EXPECT_EQ(wall.mesh.normals.col(vertex).norm(), 0);
    });
  }
}

// A surface beside a kink, where estimates go astray and brackets are halved: other roundings lead to the same
// vertices.
TEST(EdgeVertices, DependOnRoundingAsLittleAtKinks) {
  const Point<3> n = Point<3>(1, 2, 3).normalized();
  for (const bool normals : {true, false}) {
    std::vector<Mesh> meshes;
    for (const double rounded : {0.0, 1e-15}) {
      const Implicit kink(
          [=](const Point<3>& p, Point<3>& g) {
            const double s = 0.1234 - n.dot(p), steep = s > 0.003 ? 30 : 1;
            g = -steep * (1 + 6 * s) * n;
            const double f = s + 3 * s * s, there = 0.003 + 3 * 0.003 * 0.003;
            return (there + steep * (f - there)) * (1 + rounded * std::sin(1e6 * p.sum()));
          },
          cube(1));
      meshes.push_back(Vertices(kink, lattice_around(off_center, 1, 24), {.normals = normals}).mesh);
    }
    ASSERT_EQ(meshes[0].vertices.cols(), meshes[1].vertices.cols());
    EXPECT_LT((meshes[0].vertices - meshes[1].vertices).cwiseAbs().maxCoeff(), rounding);
    if (!normals) continue;
    EXPECT_LT((meshes[0].normals - meshes[1].normals).cwiseAbs().maxCoeff(), 1e-9);
  }
}

TEST(EdgeVertices, AreOnTheChordWithoutRefinement) {
  const Implicit ball = sphere(1);
  for (const bool normals : {true, false}) {
    const Vertices rough(ball, lattice_around(off_center, 1.3, 9), {.refine = false, .normals = normals});
    rough.for_each([&](int vertex, const Cell& lower, int d) {
      const double f_lo = ball(rough.lattice.position(lower)), f_hi = ball(rough.lattice.position(lower + offset(d)));
      const auto [t, off] = rough.place(vertex, lower, d);
      EXPECT_NEAR(t, std::clamp(f_lo / (f_lo - f_hi), edge_margin, 1 - edge_margin), rounding);
      EXPECT_LT(off, rounding);
      if (!normals) return;
      const Point<3> normal = (rough.mesh.vertices.col(vertex) - off_center).normalized();
      EXPECT_LT((rough.mesh.normals.col(vertex) - normal).norm(), 1e-3);  // at the place before the clamp
    });
    EXPECT_EQ(rough.evaluations, normals ? rough.mesh.vertices.cols() : 0);
  }
}

// A plane that passes corners at a few millionths of a cell: vertices held at the margin go on along the gradient.
TEST(EdgeVertices, NextToACornerAreOnThePlaneToo) {
  const CellLattice lattice{Point<3>::Constant(-1), Point<3>::Constant(0.25), Cell::Constant(8)};
  const Point<3> n = Point<3>(1, 2, 2) / 3;
  for (const double shift : {2e-5, -2e-5}) {
    const Implicit plane([=](const Point<3>& p, Point<3>& g) { return g = -4 * n, 4 * (shift - n.dot(p)); }, cube(1));
    for (const bool normals : {true, false}) {
      const Vertices vertices(plane, lattice, {.normals = normals});
      Index near = 0;
      vertices.for_each([&](int vertex, const Cell& lower, int d) {
        if (vertices.on_cap(lower, d)) return;
        const Point<3> p = vertices.mesh.vertices.col(vertex);
        EXPECT_NEAR(n.dot(p), shift, rounding);
        const auto [t, off] = vertices.place(vertex, lower, d);
        near += off > 0.5 * edge_margin * 0.25 * 0.1;
        EXPECT_GT(t, 0);
        EXPECT_LT(t, 1);
        if (!normals) return;
        EXPECT_LT((vertices.mesh.normals.col(vertex) - n).norm(), rounding);
      });
      EXPECT_GT(near, 50);
    }
  }
}

TEST(EdgeVertices, OfCapsStandAMarginOutsideTheirInsideCorner) {
  const Implicit everywhere([](const Point<3>&, Point<3>& g) { return g.setZero(), 1.0; }, cube(1));
  const CellLattice lattice{Point<3>(-1, 2, 3), Point<3>(0.25, 0.5, 1), Cell(5, 4, 6)};
  const Vertices caps(everywhere, lattice, {});
  Index count = 0;
  caps.for_each([&](int vertex, const Cell& lower, int d) {
    ++count;
    const Cell upper = lower + offset(d);
    const bool at_lower = lattice.on_boundary(lower);
    ASSERT_NE(at_lower, lattice.on_boundary(upper));
    const auto [t, off] = caps.place(vertex, lower, d);
    EXPECT_NEAR(t, at_lower ? 1 - edge_margin : edge_margin, rounding);
    EXPECT_LT(off, rounding);
    Point<3> out = Point<3>::Zero();
    for (int a = 0; a < 3; ++a) out[a] = upper[a] == lattice.cells[a] ? 1 : lower[a] == 0 ? -1 : 0;
    EXPECT_LT((caps.mesh.normals.col(vertex) - out.normalized()).norm(), rounding);
  });
  EXPECT_GT(count, 0);
  EXPECT_EQ(caps.evaluations, 0);
}

TEST(EdgeVertices, ReportFromFourFifthsOn) {
  const Implicit ball = sphere(1);
  Vertices vertices(ball, lattice_around(off_center, 1.3, 40), {});
  std::vector<double> fractions;
  place_edge_vertices(vertices.lattice, vertices.bricks, vertices.sampler, {}, vertices.mesh,
                      [&](std::string_view, double fraction) { return fractions.push_back(fraction), true; });
  ASSERT_GT(fractions.size(), 8U);
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
  EXPECT_NEAR(fractions.front(), 0.8, rounding);
  EXPECT_LT(fractions.back(), 0.95);
  EXPECT_GT(fractions.back(), 0.92);
}

}  // namespace
}  // namespace csrbf::polygonization::edge_vertices_test
