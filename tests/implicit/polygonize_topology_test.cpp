#include "implicit/polygonize_fields.hpp"

namespace csrbf::polygonize_topology_test {
namespace {

struct LatticeCount {
  Index edges = 0;
  Index cells = 0;
};

// Counts crossed edges and cells of an n^3 lattice whose outermost corners, one step outside, count as outside.
LatticeCount count_on_lattice(const Implicit& field, int n) {
  const auto inside = [&](const Eigen::Array3i& c) {
    return (c >= 0).all() && (c < n).all() && field(c.matrix().cast<double>()) >= 0;
  };
  LatticeCount count;
  for (int z = -1; z <= n; ++z)
    for (int y = -1; y <= n; ++y)
      for (int x = -1; x <= n; ++x) {
        const Eigen::Array3i c(x, y, z);
        for (int axis = 0; axis < 3; ++axis)
          count.edges += inside(c) != inside(c + Eigen::Vector3i::Unit(axis).array());
        int corners = 0;
        for (int d = 0; d < 8; ++d) corners += inside(c + Eigen::Array3i(d & 1, d >> 1 & 1, d >> 2));
        count.cells += corners > 0 && corners < 8;
      }
  return count;
}

TEST(PolygonizeTopology, FindsExactlyTheCrossedEdgesAndCellsOfTheWholeLattice) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const Implicit field = noise(13, seed);
    PolygonizeStatistics statistics;
    PolygonizeOptions options = lattice_of_noise(13);
    options.statistics = &statistics;
    const Mesh mesh = polygonize(field, options);
    const LatticeCount count = count_on_lattice(field, 13);
    EXPECT_EQ(mesh.vertices.cols() - statistics.center_vertices, count.edges);
    EXPECT_EQ(statistics.cells, count.cells);
  }
}

TEST(PolygonizeTopology, RandomFieldsGiveClosedManifolds) {
  Index centers = 0;
  for (std::uint64_t seed = 0; seed < 240; ++seed) {
    const int n = seed % 16 == 0 ? 24 : 12;
    PolygonizeStatistics statistics;
    PolygonizeOptions options = lattice_of_noise(n);
    options.statistics = &statistics;
    const Mesh mesh = polygonize(noise(n, seed, seed % 3 == 2), options);
    expect_closed_manifold(mesh);
    EXPECT_TRUE(mesh.vertices.allFinite());
    EXPECT_LT((mesh.normals.colwise().norm().array() - 1).abs().maxCoeff(), 1e-12);
    centers += statistics.center_vertices;
  }
  EXPECT_GT(centers, 0);  // the case was met
}

TEST(PolygonizeTopology, EulerNumberAndOrientationAreThoseOfTheSolid) {
  const Mesh ball_mesh = polygonize(sphere(1), {.resolution = 40});
  expect_closed_manifold(ball_mesh);
  EXPECT_EQ(topology(ball_mesh).euler, 2);
  EXPECT_GT(volume(ball_mesh), 0);

  const Mesh ring = polygonize(torus(1, 0.4), {.resolution = 60});
  expect_closed_manifold(ring);
  EXPECT_EQ(topology(ring).euler, 0);
  EXPECT_EQ(topology(ring).components, 1);
  EXPECT_GT(volume(ring), 0);
}

TEST(PolygonizeTopology, DoubleTorusHasGenusTwo) {
  const Mesh mesh = polygonize(double_torus(), {.resolution = 100});
  expect_closed_manifold(mesh);
  EXPECT_EQ(topology(mesh).components, 1);
  EXPECT_EQ(topology(mesh).euler, -2);
}

TEST(PolygonizeTopology, TouchingSpheresStayManifold) {
  const Implicit field = touching_spheres();
  for (const int resolution : {31, 40, 64}) {
    const Mesh mesh = polygonize(field, {.resolution = resolution});
    expect_closed_manifold(mesh);
    EXPECT_NEAR(volume(mesh), 3 * 4 * pi / 3, 0.03 * 4 * pi);
  }
}

TEST(PolygonizeTopology, ThinShellHasTwoComponents) {
  const double thickness = 0.04;  // above the cell of 2 / 64
  const Mesh mesh = polygonize(thin_shell(thickness), {.resolution = 64});
  expect_closed_manifold(mesh);
  EXPECT_EQ(topology(mesh).components, 2);
  EXPECT_EQ(topology(mesh).euler, 4);
  EXPECT_NEAR(volume(mesh), 4 * pi / 3 * (1 - std::pow(1 - thickness, 3)), 0.01);
}

TEST(PolygonizeTopology, GyroidThatLeavesTheBoxIsClosed) {
  const Implicit surface = gyroid();
  const Box<3> bounds = surface.bounds();
  const Mesh mesh = polygonize(surface, {.resolution = 40, .bounds = bounds});
  expect_closed_manifold(mesh);
  const double margin = edge_margin * 2 * pi / 40 + 1e-12;
  EXPECT_TRUE(bounds.inflated(margin).contains(mesh.vertices.rowwise().minCoeff()));
  EXPECT_TRUE(bounds.inflated(margin).contains(mesh.vertices.rowwise().maxCoeff()));
  EXPECT_NEAR(volume(mesh), 0.5 * std::pow(2 * pi, 3), 0.5);  // half of the cube by symmetry
}

TEST(PolygonizeTopology, ComponentsAreFoundFromTheirSeedsOnlyAndByTheScanAll) {
  const std::array<Point<3>, 3> centers{Point<3>(-2, 0.1, 0), Point<3>(0, 0.02, 0.01), Point<3>(2.03, 0, 0)};
  const auto value = [&](const Point<3>& p, Point<3>& g) {
    double best = -std::numeric_limits<double>::infinity();
    for (const Point<3>& center : centers) {
      Point<3> gradient;
      const double f = ball(p, center, 0.7, gradient);
      if (f > best) {
        best = f;
        g = gradient;
      }
    }
    return best;
  };
  const Implicit field(value, {{-3, -1, -1}, {3, 1, 1}});
  EXPECT_EQ(topology(polygonize(field, {.resolution = 50})).components, 3);
  EXPECT_EQ(topology(polygonize(field, {.resolution = 300})).components, 3);
  const Points<3> two = columns({{-2, 0, 0.68}, {2, 0.72, 0.05}});
  EXPECT_EQ(topology(polygonize(field, {.resolution = 50, .seeds = two})).components, 2);
}

TEST(PolygonizeTopology, SeedsAFewCellsFromTheSurfaceAreEnough) {
  const double cell = 2.0 / 64;
  for (const double distance : {-5.0, -1.5, 1.5, 5.0}) {
    const Points<3> seed = columns({off_center + Point<3>(1, 1, 1).normalized() * (1 + distance * cell)});
    EXPECT_EQ(topology(polygonize(sphere(1), {.resolution = 64, .seeds = seed})).euler, 2);
  }
}

}  // namespace
}  // namespace csrbf::polygonize_topology_test
