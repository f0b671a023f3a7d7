#include "csrbf/surface/trim.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/implicit/mesh/triangle_tree.hpp"
#include "surface/surface_testing.hpp"

#include <Eigen/Geometry>

#include <array>
#include <map>
#include <set>

namespace csrbf::trim_test {
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
  mesh.space = Space::right_anterior_superior;
}

void expect_attributes(const Mesh& mesh) {
  EXPECT_EQ(mesh.normals, 2 * mesh.vertices);
  ASSERT_EQ(mesh.properties.size(), 1U);
  EXPECT_EQ(mesh.properties[0].values, mesh.vertices.row(2).transpose());
  EXPECT_EQ(mesh.space, Space::right_anterior_superior);
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

Points<3> square_samples(Index n, double width, unsigned seed) {
  return random_points(n, {Point<3>::Zero(), Point<3>(width, 1, 0)}, seed);
}

// Mean distance of a sample to the six nearest.
double spacing_by_definition(const Points<3>& points, Index i) {
  Eigen::VectorXd others = (points.colwise() - points.col(i)).colwise().norm();
  std::sort(others.begin(), others.end());
  return others.segment(1, 6).mean();
}

TEST(Trim, EndsBesideTheOutermostSamples) {
  // Samples on a lattice of spacing 0.02 over the left half of a strip; six neighbours are (4 + 2 sqrt 2) / 6 away, up
  // to 1.28 h at the end of the lattice.
  constexpr double h = 0.02;
  Points<3> samples(3, 51 * 51);
  for (Index i = 0; i < samples.cols(); ++i)
    samples.col(i) << h * static_cast<double>(i % 51), h * static_cast<double>(i / 51), 0;
  const Mesh mesh = flat_mesh(400, 200, 0.005);
  for (const double distance : {1.0, 5.0, 10.0}) {
    const Mesh trimmed = trim(mesh, samples, distance);
    EXPECT_EQ(topology(trimmed).euler, 1);
    const double kept = area(trimmed);
    EXPECT_GT(kept, 1 + 0.5 * h * (4 + 2 * std::sqrt(2.0)) / 6 - 0.002);
    EXPECT_LT(kept, 1 + 0.5 * 1.28 * h + 0.002);
  }
}

TEST(Trim, KeepsEverySampleAndNothingBeyondTheDistance) {
  Mesh mesh = flat_mesh(60, 30, 1.0 / 30);
  add_attributes(mesh);
  constexpr double rounding = 1e-12, cell = 1.0 / 30;  // the spacing changes from vertex to vertex
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Points<3> samples = square_samples(200, 1.2, seed);
    for (const double distance : {0.7, 2.0, 5.0}) {
      const Mesh trimmed = trim(mesh, samples, distance);
      EXPECT_TRUE(topology(trimmed).manifold());
      EXPECT_EQ(topology(trimmed).vertices, trimmed.vertices.cols());
      EXPECT_LT((trimmed.normals - 2 * trimmed.vertices).cwiseAbs().maxCoeff(), 0.01);  // cuts keep the length
      EXPECT_LT((trimmed.properties[0].values - trimmed.vertices.row(2).transpose()).cwiseAbs().maxCoeff(), rounding);
      for (Index v = 0; v < trimmed.vertices.cols(); ++v) {
        Index nearest = 0;
        const double gap = (samples.colwise() - trimmed.vertices.col(v)).colwise().norm().minCoeff(&nearest);
        EXPECT_LE(gap, distance * spacing_by_definition(samples, nearest) + cell);
      }
      if (distance < 2) continue;
      const TriangleTree tree(trimmed);
      for (Index i = 0; i < samples.cols(); ++i) EXPECT_LT(tree.closest(samples.col(i)).distance, rounding);
    }
  }
}

TEST(Trim, FillsNarrowHolesAndFollowsTheEdgesOfWideOnes) {
  constexpr double h = 0.02;
  std::vector<Point<3>> kept;
  for (int i = -60; i <= 60; ++i)
    for (int j = -60; j <= 60; ++j)
      if (const Point<3> p(h * i, h * j, 0); std::hypot(p[0] - 0.5, p[1]) > 0.1 && std::hypot(p[0] + 0.5, p[1]) > 0.4)
        kept.push_back(p);
  Points<3> samples(3, std::ssize(kept));
  for (Index i = 0; i < samples.cols(); ++i) samples.col(i) = kept[i];
  const Mesh square = grid_mesh(240, 240, [](int i, int j) { return Point<3>(0.01 * (i - 120), 0.01 * (j - 120), 0); });
  const Mesh trimmed = trim(square, samples, 8);  // 0.18
  EXPECT_EQ(topology(trimmed).euler, 0);
  const double hole = pi * 0.4 * 0.4;
  EXPECT_NEAR(area(trimmed), 2.4 * 2.4 - hole, 2 * pi * 0.4 * h);
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
  const Mesh trimmed = trim(sphere_mesh(60), sphere.points(Eigen::all, upper), 4);
  const Topology t = topology(trimmed);
  EXPECT_EQ(t.euler, 1);
  EXPECT_EQ(t.components, 1);
  EXPECT_TRUE(t.manifold());
  EXPECT_GT(t.boundary_edges, 100);
  const double spacing = 1.2 * std::sqrt(4 * pi / 4000);
  EXPECT_LT(trimmed.vertices.row(2).minCoeff(), 0);
  EXPECT_GT(trimmed.vertices.row(2).minCoeff(), -spacing);
  EXPECT_NEAR(area(trimmed), 2 * pi, 2 * pi * spacing);
}

TEST(Trim, SeparatesSheetsThatFaceTheOtherWay) {
  // The two sides of a thin slab with samples on the upper one alone.
  Mesh upper = flat_mesh(40, 40, 0.025), lower = flat_mesh(40, 40, 0.025);
  lower.vertices.row(2).setConstant(-0.01);
  lower.triangles.row(1).swap(lower.triangles.row(2));
  Mesh slab = joined(upper, lower);
  slab.normals = Points<3>::Zero(3, slab.vertices.cols());
  slab.normals.row(2).head(upper.vertices.cols()).setOnes();
  slab.normals.row(2).tail(lower.vertices.cols()).setConstant(-1);
  const Points<3> samples = square_samples(400, 1, 3);
  const Mesh trimmed = trim(slab, samples, 6, Points<3>(Point<3>::UnitZ().replicate(1, 400)));
  EXPECT_EQ(trimmed.vertices.row(2).cwiseAbs().maxCoeff(), 0);
  EXPECT_GT(area(trimmed), 0.9);
}

TEST(Trim, KeepsNarrowPlacesThatFaceTheOtherWay) {
  Mesh mesh = flat_mesh(80, 80, 0.0125);
  const Points<3> samples = square_samples(1600, 1, 4);  // spacing 0.025
  const double narrow = 0.06, wide = 0.3;                // radii, beside 4 spacings
  for (const double radius : {narrow, wide}) {
    mesh.normals = Point<3>::UnitZ().replicate(1, mesh.vertices.cols());
    for (Index v = 0; v < mesh.vertices.cols(); ++v)
      if ((mesh.vertices.col(v) - Point<3>(0.5, 0.5, 0)).norm() < radius) mesh.normals.col(v) *= -1;
    const Mesh trimmed = trim(mesh, samples, 4, Points<3>(Point<3>::UnitZ().replicate(1, 1600)));
    EXPECT_EQ(topology(trimmed).euler, radius == narrow ? 1 : 0);
  }
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

TEST(KeepComponentsWithData, KeepsABodyWithSparseSamplesButNotALargeOneBesideDenseSamples) {
  // Of the second sphere, 300 samples all over it, or as many as close to each other as those of the first.
  const PointCloud dense = sphere_cloud(20000), other = sphere_cloud(20000, 2, 1, {5, 0, 0});
  for (const double radius : {1.0, 2.0}) {
    const Mesh mesh = joined(sphere_mesh(20), sphere_mesh(20, radius, {5, 0, 0}));
    const PointCloud cloud = csrbf::joined(dense, sphere_cloud(300, 2, radius, {5, 0, 0}));
    EXPECT_EQ(keep_components_with_data(mesh, cloud.points).dropped, 0) << radius;
  }
  const Mesh both = joined(sphere_mesh(20), sphere_mesh(20, 1, {5, 0, 0}));
  std::vector<Index> cap;
  for (Index i = 0; i < other.size(); ++i)
    if (other.points(2, i) > 0.97) cap.push_back(i);
  ASSERT_GT(cap.size(), 250U);
  Points<3> points(3, dense.size() + std::ssize(cap));
  points << dense.points, other.points(Eigen::all, cap);
  EXPECT_EQ(keep_components_with_data(both, points).dropped, 1);
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

// Warning for balls of `samples` points each, `gap` spacings apart, along a line.
std::string warning_for_balls(Index count, Index samples, double gap) {
  const double spacing = std::sqrt(4 * std::numbers::pi / static_cast<double>(samples));
  Mesh mesh;
  PointCloud cloud;
  for (Index i = 0; i < count; ++i) {
    const Point<3> center((2 + gap * spacing) * static_cast<double>(i), 0, 0);
    const PointCloud ball = sphere_cloud(samples, static_cast<unsigned>(i), 1, center);
    mesh = i == 0 ? sphere_mesh(6, 1, center) : joined(mesh, sphere_mesh(6, 1, center));
    cloud = i == 0 ? ball : csrbf::joined(cloud, ball);
  }
  return keep_components_with_data(mesh, cloud.points).warning;
}

TEST(KeepComponentsWithData, WarnsOfManyShards) {
  EXPECT_EQ(warning_for_balls(30, 40, 0.5).substr(0, 26), "30 of the 30 components of");
  EXPECT_EQ(warning_for_balls(6, 40, 0.5), "");    // few are seen in their number
  EXPECT_EQ(warning_for_balls(30, 40, 4), "");     // they stand apart
  EXPECT_EQ(warning_for_balls(30, 100, 0.5), "");  // they are well sampled
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
}  // namespace csrbf::trim_test
