#include "csrbf/surface/trim.hpp"

#include "csrbf/core/parallel.hpp"
#include "surface/surface_testing.hpp"

#include <Eigen/Geometry>

#include <array>
#include <map>
#include <set>

namespace csrbf {
namespace {

// Two triangles for each of nx x ny squares of side h; x(u, v) places the corners.
template <class Place>
Mesh grid_mesh(int nx, int ny, Place place) {
  Mesh mesh;
  mesh.vertices.resize(3, (nx + 1) * (ny + 1));
  mesh.triangles.resize(3, 2 * nx * ny);
  for (int j = 0; j <= ny; ++j)
    for (int i = 0; i <= nx; ++i) mesh.vertices.col(j * (nx + 1) + i) = place(i, j);
  Index t = 0;
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const int a = j * (nx + 1) + i, b = a + 1, c = a + nx + 1, d = c + 1;
      mesh.triangles.col(t++) << a, b, d;
      mesh.triangles.col(t++) << a, d, c;
    }
  return mesh;
}

Mesh flat_mesh(int nx, int ny, double h) {
  return grid_mesh(nx, ny, [=](int i, int j) { return Point<3>(h * i, h * j, 0); });
}

// Closed sphere: an octahedron with every face cut in n^2 and blown up.
Mesh sphere_mesh(int n, double radius = 1, const Point<3>& center = Point<3>::Zero()) {
  std::vector<Point<3>> vertices;
  std::map<std::array<int, 3>, std::int32_t> number;
  std::vector<Eigen::Vector3i> triangles;
  const auto vertex = [&](const Eigen::Vector3i& q) {
    const auto [entry, is_new] = number.emplace(std::array<int, 3>{q[0], q[1], q[2]}, vertices.size());
    if (is_new) vertices.emplace_back(center + radius * q.cast<double>().normalized());
    return entry->second;
  };
  for (const int sx : {-1, 1})
    for (const int sy : {-1, 1})
      for (const int sz : {-1, 1})
        for (int i = 0; i < n; ++i)
          for (int j = 0; j < n - i; ++j) {
            const auto at = [&](int a, int b) { return vertex({sx * a, sy * b, sz * (n - a - b)}); };
            const auto add = [&](int a, int b, int c) {
              triangles.emplace_back(sx * sy * sz > 0 ? Eigen::Vector3i(a, b, c) : Eigen::Vector3i(a, c, b));
            };
            add(at(i, j), at(i + 1, j), at(i, j + 1));
            if (j < n - i - 1) add(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
          }
  Mesh mesh;
  mesh.vertices.resize(3, static_cast<Index>(vertices.size()));
  for (std::size_t i = 0; i < vertices.size(); ++i) mesh.vertices.col(static_cast<Index>(i)) = vertices[i];
  mesh.triangles.resize(3, static_cast<Index>(triangles.size()));
  for (std::size_t i = 0; i < triangles.size(); ++i) mesh.triangles.col(static_cast<Index>(i)) = triangles[i];
  return mesh;
}

Mesh joined(const Mesh& a, const Mesh& b) {
  Mesh both;
  both.vertices.resize(3, a.vertices.cols() + b.vertices.cols());
  both.vertices << a.vertices, b.vertices;
  both.triangles.resize(3, a.triangles.cols() + b.triangles.cols());
  both.triangles << a.triangles, (b.triangles.array() + static_cast<std::int32_t>(a.vertices.cols())).matrix();
  return both;
}

void add_attributes(Mesh& mesh) {
  mesh.normals = 2 * mesh.vertices;
  mesh.properties = {{"height", "float", mesh.vertices.row(2).transpose()}};
}

void expect_attributes(const Mesh& mesh) {
  EXPECT_EQ(mesh.normals, 2 * mesh.vertices);
  ASSERT_EQ(mesh.properties.size(), 1U);
  EXPECT_EQ(mesh.properties[0].values, mesh.vertices.row(2).transpose());
}

double area(const Mesh& mesh) {
  double sum = 0;
  for (Index t = 0; t < mesh.triangles.cols(); ++t) {
    const Point<3> a = mesh.vertices.col(mesh.triangles(0, t)), b = mesh.vertices.col(mesh.triangles(1, t)),
                   c = mesh.vertices.col(mesh.triangles(2, t));
    sum += 0.5 * (b - a).cross(c - a).norm();
  }
  return sum;
}

// Triangles by the coordinates of their corners.
std::multiset<std::array<double, 9>> triangle_set(const Mesh& mesh, const std::vector<Index>& triangles) {
  std::multiset<std::array<double, 9>> set;
  for (const Index t : triangles) {
    std::array<double, 9> corners{};
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t k = 0; k < 3; ++k)
        corners[3 * c + k] = mesh.vertices(static_cast<Index>(k), mesh.triangles(static_cast<Index>(c), t));
    set.insert(corners);
  }
  return set;
}
std::multiset<std::array<double, 9>> triangle_set(const Mesh& mesh) {
  std::vector<Index> all;
  for (Index t = 0; t < mesh.triangles.cols(); ++t) all.push_back(t);
  return triangle_set(mesh, all);
}

// Triangles that trim keeps by its definition: the spacing is the mean distance to the six nearest samples.
std::vector<Index> kept_by_definition(const Mesh& mesh, const Points<3>& points, double distance) {
  std::vector<bool> near;
  for (Index v = 0; v < mesh.vertices.cols(); ++v) {
    Index nearest = 0;
    const double gap = (points.colwise() - mesh.vertices.col(v)).colwise().norm().minCoeff(&nearest);
    Eigen::VectorXd others = (points.colwise() - points.col(nearest)).colwise().norm();
    std::sort(others.begin(), others.end());
    near.push_back(gap <= distance * others.segment(1, 6).mean());
  }
  std::vector<Index> kept;
  for (Index t = 0; t < mesh.triangles.cols(); ++t) {
    const auto is_near = [&](Index c) { return near[mesh.triangles(c, t)]; };
    if (is_near(0) && is_near(1) && is_near(2)) kept.push_back(t);
  }
  return kept;
}

Points<3> square_samples(Index n, double width, unsigned seed) {
  return random_points(n, {Point<3>::Zero(), Point<3>(width, 1, 0)}, seed);
}

TEST(Trim, KeepsTheAreaWithData) {
  // Samples on a lattice of spacing 0.02 over the left half of a strip; six neighbours are (4 + 2 sqrt 2) / 6 away.
  constexpr double h = 0.02;
  Points<3> samples(3, 51 * 51);
  for (Index i = 0; i < samples.cols(); ++i)
    samples.col(i) << h * static_cast<double>(i % 51), h * static_cast<double>(i / 51), 0;
  const Mesh mesh = flat_mesh(400, 200, 0.005);
  for (const double distance : {1.0, 5.0, 10.0}) {
    const double reach = distance * h * (4 + 2 * std::sqrt(2.0)) / 6;
    // At the end of the strip the samples have neighbours on one side only, up to 1.28 h away in the mean.
    const double kept = area(trim(mesh, samples, distance));
    EXPECT_GT(kept, 1 + reach - 0.005);
    EXPECT_LT(kept, 1 + 1.2 * reach + 0.005);
  }
}

TEST(Trim, AgreesWithTheDefinition) {
  Mesh mesh = flat_mesh(60, 30, 1.0 / 30);
  add_attributes(mesh);
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Points<3> samples = square_samples(200, 1.2, seed);
    for (const double distance : {0.3, 0.7, 2.0}) {
      const Mesh trimmed = trim(mesh, samples, distance);
      EXPECT_EQ(triangle_set(trimmed), triangle_set(mesh, kept_by_definition(mesh, samples, distance)));
      EXPECT_TRUE(topology(trimmed).manifold());
      EXPECT_EQ(topology(trimmed).vertices, trimmed.vertices.cols());
      expect_attributes(trimmed);
    }
  }
}

TEST(Trim, KeepsAMeshThatHasDataEverywhere) {
  Mesh mesh = sphere_mesh(20);
  add_attributes(mesh);
  const Mesh trimmed = trim(mesh, sphere_cloud(1000).points, 3);
  EXPECT_EQ(trimmed.vertices, mesh.vertices);
  EXPECT_EQ(trimmed.triangles, mesh.triangles);
  expect_attributes(trimmed);
}

TEST(Trim, OpensASphereWhereTheDataEnd) {
  const PointCloud sphere = sphere_cloud(4000);
  std::vector<Index> upper;
  for (Index i = 0; i < sphere.size(); ++i)
    if (sphere.points(2, i) > 0) upper.push_back(i);
  const Mesh trimmed = trim(sphere_mesh(60), sphere.points(Eigen::all, upper), 2);
  const Topology t = topology(trimmed);
  EXPECT_EQ(t.euler, 1);
  EXPECT_EQ(t.components, 1);
  EXPECT_TRUE(t.manifold());
  EXPECT_GT(t.boundary_edges, 100);
  const double reach = 2 * 1.2 * std::sqrt(4 * pi / 4000);
  EXPECT_LT(trimmed.vertices.row(2).minCoeff(), 0);
  EXPECT_GT(trimmed.vertices.row(2).minCoeff(), -1.5 * reach);
  EXPECT_NEAR(area(trimmed), 2 * pi * (1 + reach), 2 * pi * 0.5 * reach);
}

TEST(Trim, DoublesAVertexThatWouldJoinTwoPieces) {
  // A hexagon of six triangles around vertex 0; no data at vertices 3 and 6.
  Mesh mesh;
  mesh.vertices.resize(3, 7);
  mesh.vertices.col(0).setZero();
  for (int k = 1; k <= 6; ++k) mesh.vertices.col(k) << std::cos(k * pi / 3), std::sin(k * pi / 3), 0;
  mesh.triangles.resize(3, 6);
  for (int k = 1; k <= 6; ++k) mesh.triangles.col(k - 1) << 0, k, k % 6 + 1;
  add_attributes(mesh);
  Points<3> samples(3, 40);
  for (Index i = 0; i < 40; ++i) {
    const std::array<Index, 5> with_data = {0, 1, 2, 4, 5};
    samples.col(i) = mesh.vertices.col(with_data[i % 5]) + 0.05 * sphere_cloud(40).points.col(i);
  }
  const Mesh trimmed = trim(mesh, samples, 3);
  const Topology t = topology(trimmed);
  EXPECT_EQ(trimmed.triangles.cols(), 2);
  EXPECT_EQ(trimmed.vertices.cols(), 6);
  EXPECT_EQ(t.components, 2);
  EXPECT_TRUE(t.manifold());
  expect_attributes(trimmed);
}

TEST(Trim, LeavesNothingWhereThereAreNoData) {
  const Points<3> far = square_samples(50, 1, 1).array() + 100;
  const Mesh trimmed = trim(flat_mesh(10, 10, 0.1), far, 3);
  EXPECT_EQ(trimmed.triangles.cols(), 0);
  EXPECT_EQ(trimmed.vertices.cols(), 0);
}

TEST(Trim, DoesNotDependOnTheUnitTheThreadsOrTheOrderOfThePoints) {
  const Mesh mesh = flat_mesh(60, 30, 1.0 / 30);
  const Points<3> samples = square_samples(300, 1.2, 9);
  const Mesh expected = trim(mesh, samples, 0.7);
  for (const double scale : {0x1p-100, 0x1p100}) {
    Mesh scaled = mesh;
    scaled.vertices *= scale;
    const Mesh trimmed = trim(scaled, scale * samples, 0.7);
    EXPECT_EQ(trimmed.vertices, scale * expected.vertices);
    EXPECT_EQ(trimmed.triangles, expected.triangles);
  }
  set_thread_count(1);
  const Mesh serial = trim(mesh, samples.rowwise().reverse(), 0.7);
  set_thread_count(0);
  EXPECT_EQ(serial.vertices, expected.vertices);
  EXPECT_EQ(serial.triangles, expected.triangles);
}

TEST(Trim, RejectsDistancesThatAreNotPositiveAndTooFewPoints) {
  const Mesh mesh = flat_mesh(2, 2, 1);
  const Points<3> samples = square_samples(50, 1, 1);
  EXPECT_EQ(invalid_input_message([&] { trim(mesh, samples, 0); }),
            "trim: distance = 0: must be a positive number of local spacings");
  EXPECT_THROW(trim(mesh, samples, -1), InvalidInput);
  EXPECT_THROW(trim(mesh, samples, std::nan("")), InvalidInput);
  EXPECT_EQ(invalid_input_message([&] { trim(mesh, samples.leftCols(1), 1); }),
            "trim: points = 1: at least 2 are needed");
}

TEST(KeepComponentsWithData, DropsThoseWithout) {
  Mesh mesh = joined(joined(sphere_mesh(12, 1, {5, 0, 0}), sphere_mesh(20)), sphere_mesh(8, 0.3, {0, 4, 0}));
  add_attributes(mesh);
  const DataComponents kept = keep_components_with_data(mesh, sphere_cloud(1000).points);
  EXPECT_EQ(kept.dropped, 2);
  EXPECT_EQ(kept.mesh.vertices, sphere_mesh(20).vertices);
  EXPECT_EQ(kept.mesh.triangles, sphere_mesh(20).triangles);
  expect_attributes(kept.mesh);
}

TEST(KeepComponentsWithData, KeepsThemAllWhenAllHoldData) {
  const Mesh mesh = joined(sphere_mesh(20), sphere_mesh(12, 1, {5, 0, 0}));
  const PointCloud cloud = csrbf::joined(sphere_cloud(5000), sphere_cloud(500, 2, 1, {5, 0, 0}));
  const DataComponents kept = keep_components_with_data(mesh, cloud.points);
  EXPECT_EQ(kept.dropped, 0);
  EXPECT_EQ(kept.mesh.vertices, mesh.vertices);
  EXPECT_EQ(kept.mesh.triangles, mesh.triangles);
}

TEST(KeepComponentsWithData, KeepsASmallObjectWithItsFewSamplesButNotALargeOne) {
  // 400 samples per unit of area: a sphere of radius 0.05 has 12.6.
  const PointCloud cloud = csrbf::joined(sphere_cloud(5000), sphere_cloud(12, 2, 0.05, {3, 0, 0}));
  const Mesh both = joined(sphere_mesh(20), sphere_mesh(5, 0.05, {3, 0, 0}));
  EXPECT_EQ(keep_components_with_data(both, cloud.points).dropped, 0);
  EXPECT_EQ(keep_components_with_data(both, cloud.points.leftCols(5007)).dropped, 1);
  const DataComponents large =
      keep_components_with_data(joined(sphere_mesh(20), sphere_mesh(20, 1, {3, 0, 0})), cloud.points);
  EXPECT_EQ(large.dropped, 1);
}

TEST(KeepComponentsWithData, DropsABubbleBetweenTwoSheets) {
  const double gap = 0.03;  // about the distance of samples
  const PointCloud cloud = csrbf::joined(sphere_cloud(20000), sphere_cloud(20000, 2, 1 - gap));
  const Mesh sheets = joined(sphere_mesh(20), sphere_mesh(20, 1 - gap));
  const Mesh bubble = sphere_mesh(3, 0.3 * gap, {0, 0, 1 - 0.5 * gap});
  EXPECT_EQ(keep_components_with_data(sheets, cloud.points).dropped, 0);
  const DataComponents kept = keep_components_with_data(joined(sheets, bubble), cloud.points);
  ASSERT_EQ(kept.dropped, 1);
  EXPECT_EQ(kept.mesh.vertices, sheets.vertices);
}

TEST(KeepComponentsWithData, NeverDropsAll) {
  const Mesh two = joined(sphere_mesh(5), sphere_mesh(5, 1, {5, 0, 0}));
  EXPECT_EQ(keep_components_with_data(two, Points<3>(3, 0)).mesh.triangles, two.triangles);
  const DataComponents kept = keep_components_with_data(two, Point<3>(5, 0, 3));
  EXPECT_EQ(kept.dropped, 1);
  EXPECT_GT(kept.mesh.vertices.row(0).minCoeff(), 3);
  const Mesh one = sphere_mesh(5);
  EXPECT_EQ(keep_components_with_data(one, Point<3>(50, 0, 0)).mesh.triangles, one.triangles);
  EXPECT_EQ(keep_components_with_data({}, Point<3>(50, 0, 0)).mesh.triangles.cols(), 0);
}

}  // namespace
}  // namespace csrbf
