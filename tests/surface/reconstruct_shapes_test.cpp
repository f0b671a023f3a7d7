#include "csrbf/core/parallel.hpp"
#include "csrbf/implicit/combine.hpp"
#include "csrbf/implicit/compare.hpp"
#include "csrbf/implicit/polygonize.hpp"
#include "csrbf/surface/reconstruct.hpp"
#include "csrbf/surface/trim.hpp"
#include "surface/oriented_shapes.hpp"
#include "surface/surface_testing.hpp"

namespace csrbf::reconstruct_shapes_test {
namespace {

Mesh mesh_of(const PointCloud& cloud, const ReconstructOptions& options = {}, int resolution = 96) {
  return polygonize(*reconstruct(cloud, options).field, {.resolution = resolution});
}

PointCloud without_normals(PointCloud cloud) {
  cloud.normals.resize(3, 0);
  return cloud;
}

template <class Distance>
Eigen::ArrayXd distances(const Mesh& mesh, Distance distance) {
  Eigen::ArrayXd result(mesh.vertices.cols());
  for (Index v = 0; v < result.size(); ++v) result[v] = std::abs(distance(Point<3>(mesh.vertices.col(v))));
  return result;
}

double rms(const Eigen::ArrayXd& x) {
  return std::sqrt(x.square().mean());
}

double torus_depth(const Point<3>& p) {
  return Torus().depth(p);
}

// Box centred at the origin, with samples `spacing` apart on its faces; flat faces keep their normals up to the edges.
struct Block {
  Point<3> half;

  [[nodiscard]] double depth(const Point<3>& p) const {
    const Point<3> q = p.cwiseAbs() - half;
    return -q.cwiseMax(0).norm() - std::min(q.maxCoeff(), 0.0);
  }
  [[nodiscard]] PointCloud cloud(double spacing) const {
    std::vector<Point<3>> points, normals;
    for (int axis = 0; axis < 3; ++axis)
      for (const int side : {-1, 1}) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        const auto n = static_cast<Index>(4 * half[u] * half[v] / (spacing * spacing) + 0.5);
        for (Index i = 0; i < n; ++i) {
          const Eigen::Vector2d uv =
              2 * quasi_random(i, static_cast<unsigned>(2 * axis + side + 1)) - Eigen::Vector2d(1, 1);
          Point<3> p;
          p[axis] = side * half[axis];
          p[u] = uv[0] * half[u];
          p[v] = uv[1] * half[v];
          points.push_back(p);
          normals.emplace_back(side * Point<3>::Unit(axis));
        }
      }
    PointCloud result{
        Points<3>(3, static_cast<Index>(points.size())), Points<3>(3, static_cast<Index>(points.size())), {}};
    for (std::size_t i = 0; i < points.size(); ++i) {
      result.points.col(static_cast<Index>(i)) = points[i];
      result.normals.col(static_cast<Index>(i)) = normals[i];
    }
    return result;
  }
};

PointCloud square_cloud(Index n) {
  PointCloud cloud{Points<3>(3, n), Point<3>::UnitZ().replicate(1, n), {}};
  for (Index i = 0; i < n; ++i) cloud.points.col(i) << quasi_random(i, 1), 0;
  return cloud;
}

TEST(ReconstructShapes, ATorusIsClosedAndAccurate) {
  const Reconstruction result = reconstruct(Torus().cloud(4000));
  const Mesh mesh = polygonize(*result.field, {.resolution = 96});
  expect_closed(mesh, 1, 0);
  const double spacing = std::sqrt(Torus().area() / 4000);
  EXPECT_LT(rms(distances(mesh, torus_depth)), 2e-3 * spacing);
  EXPECT_LT(distances(mesh, torus_depth).maxCoeff(), 0.05 * spacing);
}

TEST(ReconstructShapes, ATorusWithoutNormalsIsTheSame) {
  const PointCloud cloud = Torus().cloud(4000);
  const Mesh mesh = mesh_of(without_normals(cloud));
  expect_closed(mesh, 1, 0);
  EXPECT_LT(rms(distances(mesh, torus_depth)), 0.02 * std::sqrt(Torus().area() / 4000));
  EXPECT_LT(compare(mesh, mesh_of(cloud), {.samples = 20000}).normal_error_deg, 2);  // outward too
}

TEST(ReconstructShapes, SpheresAFewSpacingsApartStayTwo) {
  const double gap = 4 * std::sqrt(4 * pi / 2000);
  const PointCloud cloud = joined(sphere_cloud(2000), sphere_cloud(2000, 2, 1, {2 + gap, 0, 0}));
  expect_closed(mesh_of(cloud), 2, 4);
  expect_closed(mesh_of(without_normals(cloud)), 2, 4);
}

// Quadrics fit a sphere on patches of any size, but patches that reach the other sphere could spoil it. Those of the
// cross-validation do not reach it with the seeds 2 (by plain x86-64), 29, 51 and 59 (by AVX-512) at distance 3. The
// bound is 2 % of the spacing: a piece with few samples of the other sphere, at the rim, is not exact.
TEST(ReconstructShapes, SpheresAreAccurateBesideEachOther) {
  for (const unsigned seed : {0U, 1U, 2U, 29U, 51U, 59U})
    for (const double distance : {2.3, 3.0}) {
      const Point<3> other(distance, 0, 0);
      const Shape pair = join(random_sphere(2000, 2 * seed), random_sphere(2000, 2 * seed + 1, other));
      const Reconstruction result = reconstruct({pair.points, {}, {}});
      EXPECT_LT(result.report.max_distance, 4e-4) << "seed " << seed << ", distance " << distance;
    }
}

TEST(ReconstructShapes, AHollowSphereHasTwoWalls) {
  PointCloud inner = sphere_cloud(1200, 2, 0.7);
  inner.normals *= -1;
  const PointCloud cloud = joined(sphere_cloud(2500), inner);
  const Reconstruction result = reconstruct(cloud);
  expect_closed(polygonize(*result.field, {.resolution = 96}), 2, 4);
  EXPECT_LT((*result.field)(Point<3>::Zero()), 0);
  EXPECT_GT((*result.field)(Point<3>(0, 0.85, 0)), 0);
}

TEST(ReconstructShapes, ACubeKeepsItsFacesAndNearlyItsEdges) {
  const Block cube{{1, 1, 1}};
  constexpr double spacing = 0.05;
  const Mesh mesh = mesh_of(cube.cloud(spacing));
  expect_closed(mesh, 1, 2);
  const Eigen::ArrayXd error = distances(mesh, [&](const Point<3>& p) { return cube.depth(p); });
  EXPECT_LT(error.maxCoeff(), 2 * spacing);
  // Further than a patch from the edges the faces are planes.
  double on_faces = 0;
  for (Index v = 0; v < error.size(); ++v) {
    Point<3> p = mesh.vertices.col(v).cwiseAbs();
    std::sort(p.begin(), p.end());
    if (p[1] < 1 - 8 * spacing) on_faces = std::max(on_faces, error[v]);
  }
  EXPECT_LT(on_faces, 1e-6);
}

TEST(ReconstructShapes, TheMethodOfTheMeshKeepsEdgesAndCornersUnlessThereIsNoise) {
  const Block cube{{1, 1, 1}};
  constexpr double spacing = 0.05;
  const Reconstruction exact = reconstruct(cube.cloud(spacing));
  EXPECT_EQ(mesh_method(*exact.field), PolygonizeMethod::dual_contouring);
  const Mesh mesh = polygonize(*exact.field, {.resolution = 41, .method = mesh_method(*exact.field)});
  expect_closed(mesh, 1, 2);
  for (const double x : {-1., 1.})
    for (const double y : {-1., 1.})
      for (const double z : {-1., 1.})
        EXPECT_LT((mesh.vertices.colwise() - Point<3>(x, y, z)).colwise().norm().minCoeff(), 0.1 * spacing);

  const Reconstruction noisy = reconstruct(with_noise(cube.cloud(spacing), 0.3 * spacing));
  EXPECT_EQ(mesh_method(*noisy.field), PolygonizeMethod::marching_cubes);
  ReconstructOptions tangent_planes;
  tangent_planes.method = "hoppe";
  EXPECT_EQ(mesh_method(*reconstruct(cube.cloud(spacing), tangent_planes).field), PolygonizeMethod::marching_cubes);
}

TEST(ReconstructShapes, WhatIsCombinedOfSharpSurfacesKeepsItsEdge) {
  const Block cube{{1, 1, 1}};
  constexpr double spacing = 0.08;
  const auto near = reconstruct(cube.cloud(spacing)).field;
  PointCloud moved = cube.cloud(spacing);
  moved.points.colwise() += Point<3>(0.93, 0.87, 0.81);
  const auto far = reconstruct(moved).field;
  const auto noisy = reconstruct(with_noise(cube.cloud(spacing), 0.3 * spacing)).field;
  for (const Blending blending : {Blending::sharp, Blending::super_elliptic})
    EXPECT_EQ(mesh_method(*combine(Operation::subtract, {near, far}, {.blending = blending})),
              PolygonizeMethod::dual_contouring);
  EXPECT_EQ(mesh_method(*combine(Operation::unite, {near, noisy})), PolygonizeMethod::marching_cubes);

  // What is cut away ends in a corner inside, and edges that start there.
  const Solid notched = combine(Operation::subtract, {near, far}, {.blending = Blending::sharp});
  const Mesh mesh = polygonize(*notched, {.resolution = 31, .method = mesh_method(*notched)});
  expect_closed(mesh, 1, 2);
  const Point<3> corner(-0.07, -0.13, -0.19);
  EXPECT_LT((mesh.vertices.colwise() - corner).colwise().norm().minCoeff(), 0.1 * spacing);
}

TEST(ReconstructShapes, AThinSlabKeepsItsTwoSides) {
  constexpr double spacing = 0.04;
  for (const double thickness : {2.0, 1.0}) {
    const Block slab{{0.8, 1, 0.5 * thickness * spacing}};
    const Mesh mesh = mesh_of(slab.cloud(spacing), {}, 200);
    expect_closed(mesh, 1, 2);
    EXPECT_LT(distances(mesh, [&](const Point<3>& p) { return slab.depth(p); }).maxCoeff(), 2 * spacing) << thickness;
  }
}

TEST(ReconstructShapes, ASquareIsClosedAndOpenedAgainByTrim) {
  const PointCloud cloud = square_cloud(2500);
  const Mesh closed = mesh_of(cloud);
  expect_closed(closed, 1, 2);
  const Mesh open = keep_components_with_data(trim(closed, cloud.points, 2, cloud.normals), cloud.points).mesh;
  const Topology t = topology(open);
  EXPECT_EQ(t.euler, t.components);  // discs: no holes, nothing closed
  EXPECT_TRUE(t.manifold());
  const double spacing = 0.02;
  EXPECT_LT(open.vertices.row(2).cwiseAbs().maxCoeff(), 3 * spacing);
  EXPECT_GT(open.vertices.row(0).maxCoeff(), 1 - spacing);
  EXPECT_LT(open.vertices.row(0).maxCoeff(), 1 + 3 * spacing);
}

// Hills of a fifth of the width with noise of a tenth of the spacing, as from the air.
PointCloud hills(Index n) {
  PointCloud cloud{Points<3>(3, n), Points<3>(3, 0), {}};
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, 0.1 / std::sqrt(static_cast<double>(n)));
  for (Index i = 0; i < n; ++i) {
    const Eigen::Vector2d p = quasi_random(i, 1);
    cloud.points.col(i) << p, 0.1 * std::sin(9 * p[0]) * std::cos(7 * p[1]) + noise(random);
  }
  return cloud;
}

TEST(ReconstructShapes, ATerrainIsOneSheetWithoutPits) {
  const PointCloud cloud = hills(6000);
  const Reconstruction terrain = reconstruct(cloud);
  EXPECT_GT(terrain.normals.row(2).minCoeff(), 0);
  const Mesh closed = polygonize(*terrain.field, {});
  EXPECT_TRUE(topology(closed).watertight());
  const Points<3> used = cloud.points(Eigen::all, terrain.source);
  const Mesh open = keep_components_with_data(trim(closed, used, 5, terrain.normals), used).mesh;
  const Topology t = topology(open);
  EXPECT_EQ(t.components, 1);
  EXPECT_EQ(t.euler, 1);
  const double spacing = 1 / std::sqrt(6000.0);
  Eigen::ArrayXd height(open.vertices.cols());
  for (Index v = 0; v < height.size(); ++v) {
    const Point<3> p = open.vertices.col(v);
    height[v] = std::abs(p[2] - 0.1 * std::sin(9 * p[0]) * std::cos(7 * p[1]));
  }
  EXPECT_LT(rms(height), 0.1 * spacing);
  EXPECT_LT(height.maxCoeff(), spacing);
}

TEST(ReconstructShapes, UnevenDensityIsNoReasonForHoles) {
  // Density falls by a factor of nine from pole to pole.
  const PointCloud sphere = sphere_cloud(12000);
  std::vector<Index> kept;
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (Index i = 0; i < sphere.size(); ++i)
    if (uniform(random) < std::pow(3.0, -1 - sphere.points(2, i))) kept.push_back(i);
  const Mesh mesh = mesh_of({sphere.points(Eigen::all, kept), sphere.normals(Eigen::all, kept), {}});
  expect_closed(mesh, 1, 2);
  EXPECT_LT(distances(mesh, [](const Point<3>& p) { return 1 - p.norm(); }).maxCoeff(), 0.01);
}

TEST(ReconstructShapes, NoiseIsAveragedOut) {
  constexpr double noise = 0.005 * 3.88;  // half a percent of the diagonal, 0.6 spacings
  const PointCloud cloud = with_noise(Torus().cloud(8000), noise);
  const Reconstruction result = reconstruct(cloud);
  const Mesh mesh = polygonize(*result.field, {.resolution = 96});
  expect_closed(mesh, 1, 0);
  EXPECT_LT(rms(distances(mesh, torus_depth)), 0.3 * noise);
  EXPECT_NEAR(result.report.rms_distance * 3.88, noise, 0.15 * noise);
}

TEST(ReconstructShapes, StrayPointsLeaveOneLargeComponent) {
  const PointCloud good = Torus().cloud(5000);
  PointCloud strays{random_points(50, bounding_box<3>(good.points), 3), Points<3>(3, 50), {}};
  strays.normals = random_points(50, {-Point<3>::Ones(), Point<3>::Ones()}, 4).colwise().normalized();
  const PointCloud cloud = joined(good, strays);
  for (const PointCloud& input : {cloud, without_normals(cloud)}) {
    const Reconstruction result = reconstruct(input);
    const Points<3> used = input.points(Eigen::all, result.source);
    const Mesh mesh = keep_components_with_data(polygonize(*result.field, {.resolution = 96}), used).mesh;
    EXPECT_TRUE(topology(mesh).watertight());
    EXPECT_TRUE(topology(mesh).manifold());
    EXPECT_LE(topology(mesh).components, 3);
    const MeshComparison difference = compare(mesh, mesh_of(good), {.samples = 20000});
    EXPECT_LT(difference.completeness.p99, 1.5e-3);
    EXPECT_LT(difference.accuracy.mean, 2e-3);
  }
}

TEST(ReconstructShapes, SimilarityTransformsGiveTheSameSurface) {
  const PointCloud cloud = Torus().cloud(4000);
  const Mesh expected = mesh_of(cloud);
  Similarity small, large = rotation(1), moved = rotation(2);
  small.scale = 1e-30;
  large.scale = 1e30;
  moved.scale = 1e-3;
  moved.shift << 1, -2, 3;
  for (const Similarity& map : {small, large, moved}) {
    Mesh mesh = mesh_of(map(cloud));
    expect_closed(mesh, 1, 0);
    mesh.vertices = map.R.transpose() * ((mesh.vertices.colwise() - map.shift) / map.scale);
    const MeshComparison difference = compare(mesh, expected, {.samples = 20000});
    // Chords of the triangles, 1/96 of the size: two meshes of one surface differ by up to c^2 k / 8 = 4e-4 / 3.88.
    EXPECT_LT(difference.hausdorff99, 2e-4);
    // Vertices are on the surface itself.
    EXPECT_NEAR(rms(distances(mesh, torus_depth)), rms(distances(expected, torus_depth)), 2e-5);
  }
}

TEST(ReconstructShapes, OneAndTwoThreadsGiveTheSameMesh) {
  for (const PointCloud& cloud : {Torus().cloud(4000), without_normals(Torus().cloud(4000))}) {
    set_thread_count(1);
    const Mesh serial = mesh_of(cloud);
    set_thread_count(2);
    const Mesh parallel = mesh_of(cloud);
    set_thread_count(0);
    EXPECT_EQ(serial.vertices, parallel.vertices);
    EXPECT_EQ(serial.triangles, parallel.triangles);
    EXPECT_EQ(serial.normals, parallel.normals);
  }
}

TEST(ReconstructShapes, FourPointsAreEnough) {
  PointCloud corners{Points<3>(3, 4), Points<3>(3, 0), {}};
  corners.points << 0, 1, 0, 0,  //
      0, 0, 1, 0,                //
      0, 0, 0, 1;
  EXPECT_TRUE(topology(mesh_of(corners)).watertight());
  corners.normals = (corners.points.colwise() - corners.points.rowwise().mean()).colwise().normalized();
  const Reconstruction result = reconstruct(corners);
  EXPECT_TRUE(topology(polygonize(*result.field)).watertight());
  EXPECT_GT((*result.field)(corners.points.rowwise().mean()), 0);
}

TEST(ReconstructShapes, WarnWhereTooFewPointsTellNoShape) {
  PointCloud corners{Points<3>(3, 8), {}, {}};
  for (Index i = 0; i < 8; ++i) corners.points.col(i) << double(i & 1), double(i >> 1 & 1), double(i >> 2 & 1);
  const std::vector<std::string> warnings = reconstruct(corners).report.warnings;
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings.front().find("too few"), std::string::npos);
  EXPECT_TRUE(reconstruct(with_noise(sphere_cloud(2000), 0.05)).report.warnings.empty());
}

TEST(ReconstructShapes, TheReportTellsWhatWasDone) {
  PointCloud cloud = Torus().cloud(4000);
  cloud.points(0, 9) = std::nan("");
  const Reconstruction result = reconstruct(cloud);
  const ReconstructReport& report = result.report;
  EXPECT_EQ(report.method, "composite");
  EXPECT_EQ(report.normals, NormalSource::file);
  EXPECT_EQ(report.points, 4000);
  EXPECT_EQ(report.points_used, 3999);
  EXPECT_EQ(static_cast<Index>(result.source.size()), 3999);
  ASSERT_EQ(report.warnings.size(), 1U);
  EXPECT_EQ(report.warnings[0], "1 points with NaN or infinite coordinates dropped");
  ASSERT_TRUE(report.composite);
  EXPECT_GT(report.composite->patches, 200);
  EXPECT_GT(report.centers, report.composite->patches);
  EXPECT_GE(report.composite->levels, 2);
  EXPECT_GT(report.composite->settings.leaf_size, 0);
  EXPECT_GT(report.composite->cross_validation_error, 0);
  EXPECT_LE(report.rms_distance, report.p99_distance);
  EXPECT_LE(report.p99_distance, report.max_distance);
  EXPECT_LT(report.max_distance, 1e-3);
  EXPECT_GE(report.prepare_seconds, 0);
  EXPECT_GT(report.fit_seconds, 0);
  EXPECT_GT(report.evaluate_seconds, 0);
}

TEST(ReconstructShapes, TheMethodIsTheCompositeOne) {
  const PointCloud cloud = Torus().cloud(2000);
  const Points<3> x = random_points(500, {-2 * Point<3>::Ones(), 2 * Point<3>::Ones()}, 1);
  EXPECT_EQ(reconstruct(cloud, {.method = "composite"}).field->evaluate(x).value,
            reconstruct(cloud).field->evaluate(x).value);
}

}  // namespace
}  // namespace csrbf::reconstruct_shapes_test
