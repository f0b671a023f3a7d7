#include "core/error_testing.hpp"
#include "csrbf/core/parallel.hpp"
#include "implicit/polygonize_fields.hpp"

#include <Eigen/Geometry>

namespace csrbf::polygonize_method_test {
namespace {

// What holds for every method.
class EveryMethod : public testing::TestWithParam<PolygonizeMethod> {
 protected:
  [[nodiscard]] Mesh polygonized(const Field<3>& field, PolygonizeOptions options) const {
    options.method = GetParam();
    return polygonize(field, options);
  }
};

TEST_P(EveryMethod, GivesClosedManifoldsOfTheRightGenus) {
  const Mesh ring = polygonized(torus(1, 0.4), {.resolution = 50});
  expect_closed_manifold(ring);
  EXPECT_EQ(topology(ring).euler, 0);
  EXPECT_EQ(topology(ring).components, 1);
  EXPECT_GT(volume(ring), 0);

  const Mesh two_holes = polygonized(double_torus(), {.resolution = 100});
  expect_closed_manifold(two_holes);
  EXPECT_EQ(topology(two_holes).euler, -2);
  EXPECT_EQ(topology(two_holes).components, 1);

  const Mesh box = polygonized(turned_box({0.7, 0.5, 0.4}), {.resolution = 31});
  expect_closed_manifold(box);
  EXPECT_EQ(topology(box).euler, 2);
}

TEST_P(EveryMethod, KeepsTouchingSpheresManifold) {
  for (const int resolution : {31, 40, 64}) {
    const Mesh mesh = polygonized(touching_spheres(), {.resolution = resolution});
    expect_closed_manifold(mesh);
    EXPECT_NEAR(volume(mesh), 3 * 4 * pi / 3, 0.03 * 4 * pi);
  }
}

TEST_P(EveryMethod, KeepsTheSidesOfAThinShellApart) {
  for (const double cells : {0.7, 1.2, 1.8}) {
    const Mesh mesh = polygonized(thin_shell(cells * 2 / 64), {.resolution = 64});
    expect_closed_manifold(mesh);
    if (cells < std::sqrt(3)) continue;  // diagonals may step over it: holes
    EXPECT_EQ(topology(mesh).components, 2);
    EXPECT_EQ(topology(mesh).euler, 4);
  }
}

TEST_P(EveryMethod, GivesClosedManifoldsForRandomFields) {
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const int n = seed % 16 == 0 ? 24 : 12;
    const Mesh mesh = polygonized(noise(n, seed, seed % 3 == 2), lattice_of_noise(n));
    expect_closed_manifold(mesh);
    EXPECT_TRUE(mesh.vertices.allFinite());
    EXPECT_LT((mesh.normals.colwise().norm().array() - 1).abs().maxCoeff(), 1e-12);
  }
}

TEST_P(EveryMethod, ClosesTheSolidAtTheBox) {
  const Box<3> bounds = gyroid().bounds();
  const Mesh mesh = polygonized(gyroid(), {.resolution = 40, .bounds = bounds});
  expect_closed_manifold(mesh);
  const double margin = edge_margin * 2 * pi / 40 + 1e-12;
  EXPECT_TRUE(bounds.inflated(margin).contains(mesh.vertices.rowwise().minCoeff()));
  EXPECT_TRUE(bounds.inflated(margin).contains(mesh.vertices.rowwise().maxCoeff()));
  EXPECT_NEAR(volume(mesh), 0.5 * std::pow(2 * pi, 3), 0.5);  // half of the cube by symmetry
}

// Mean order over all halvings.
double observed_order(const std::vector<double>& errors) {
  return std::log2(errors.front() / errors.back()) / static_cast<double>(errors.size() - 1);
}

// For an order the tolerance of the adaptive method must shrink with the errors of the others.
double small_tolerance(int resolution) {
  return 1.3 / (resolution * resolution);
}

TEST_P(EveryMethod, ConvergesWithOrderTwo) {
  std::vector<double> area_errors, volume_errors;
  for (const int resolution : {12, 24, 48, 96, 192}) {
    const Mesh mesh = polygonized(torus(1, 0.4), {.resolution = resolution, .tolerance = small_tolerance(resolution)});
    area_errors.push_back(std::abs(areas(mesh).sum() - 4 * pi * pi * 0.4));
    volume_errors.push_back(std::abs(volume(mesh) - 2 * pi * pi * 0.16));
  }
  EXPECT_GT(observed_order(area_errors), 1.9);
  EXPECT_GT(observed_order(volume_errors), 1.9);
}

// Mean order of the root mean square: the largest distance meets worse cells the more there are.
TEST_P(EveryMethod, PutsVerticesOnTheSurfaceWithRefinementAndToOrderTwoWithout) {
  std::vector<double> errors;
  for (const int resolution : {8, 16, 32, 64, 128}) {
    const Mesh rough =
        polygonized(sphere(1), {.resolution = resolution, .tolerance = small_tolerance(resolution), .refine = false});
    const Eigen::ArrayXd radii = (rough.vertices.colwise() - off_center).colwise().norm();
    errors.push_back(std::sqrt((radii - 1).square().mean()));
    EXPECT_LT(largest_distance_to_sphere(polygonized(sphere(1), {.resolution = resolution}), 1, off_center), 1e-6);
  }
  EXPECT_GT(observed_order(errors), 1.9);
}

TEST_P(EveryMethod, DoesNotDependOnTheNumberOfThreads) {
  const Implicit ring = torus(1, 0.35), rough = noise(20, 7);
  std::vector<Mesh> smooth_meshes, rough_meshes;
  for (const int threads : {1, 2, 3}) {
    set_thread_count(threads);
    smooth_meshes.push_back(polygonized(ring, {.resolution = 60}));
    rough_meshes.push_back(polygonized(rough, lattice_of_noise(20)));
  }
  set_thread_count(0);
  for (std::size_t i = 1; i < 3; ++i) {
    EXPECT_TRUE(identical(smooth_meshes[0], smooth_meshes[i]));
    EXPECT_TRUE(identical(rough_meshes[0], rough_meshes[i]));
  }
}

TEST_P(EveryMethod, ScalesWithSpaceAndValues) {
  const Mesh unit = polygonized(sphere(1), {.resolution = 33});
  for (const double scale : {0x1p-100, 0x1p100}) {  // powers of two: every operation scales exactly
    const Implicit scaled(
        [=](const Point<3>& p, Point<3>& g) {
          const double f = ball(p / scale, off_center, 1, g) / scale;
          g /= scale * scale;
          return f;
        },
        {(off_center.array() - 1) * scale, (off_center.array() + 1) * scale},
        columns({scale * (off_center + Point<3>(1, 0, 0))}));
    const Mesh mesh = polygonized(scaled, {.resolution = 33});
    EXPECT_TRUE(mesh.triangles == unit.triangles);
    EXPECT_LT((mesh.vertices / scale - unit.vertices).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST_P(EveryMethod, GivesOutwardUnitNormalsOrNone) {
  const Mesh mesh = polygonized(sphere(1), {.resolution = 64});
  const Points<3> expected = (mesh.vertices.colwise() - off_center).colwise().normalized();
  const double curvature_times_last_step = 0.05 * 2 / 64;
  EXPECT_LT((mesh.normals - expected).colwise().norm().maxCoeff(), curvature_times_last_step);
  const Mesh without = polygonized(sphere(1), {.resolution = 64, .normals = false});
  EXPECT_EQ(without.normals.cols(), 0);
  EXPECT_EQ(without.triangles.cols(), mesh.triangles.cols());
}

TEST_P(EveryMethod, TakesNormalsFromTheTrianglesWhereTheGradientVanishes) {
  const Implicit step([](const Point<3>& p, Point<3>& g) { return g.setZero(), p.norm() < 1 ? 1.0 : -1.0; }, cube(1));
  const Mesh mesh = polygonized(step, {.resolution = 24});
  expect_closed_manifold(mesh);
  EXPECT_NEAR(volume(mesh), 4 * pi / 3, 0.1);  // vertices are on the surface only to a share of a cell
  EXPECT_LT((mesh.normals.colwise().norm().array() - 1).abs().maxCoeff(), 1e-12);
}

TEST_P(EveryMethod, ReportsGrowingProgressAndCanBeCancelled) {
  double last = 0;
  int calls = 0;
  const auto watch = [&](std::string_view stage, double fraction) {
    EXPECT_EQ(stage, "polygonize");
    EXPECT_GE(fraction, last);
    last = fraction;
    ++calls;
    return true;
  };
  (void)polygonized(sphere(1), {.resolution = 40, .progress = watch});
  EXPECT_EQ(last, 1);
  for (int stop_at = 1; stop_at <= calls; ++stop_at) {
    int count = 0;
    const auto stop = [&](std::string_view, double) { return ++count < stop_at; };
    EXPECT_THROW((void)polygonized(sphere(1), {.resolution = 40, .progress = stop}), Cancelled);
  }
}

TEST_P(EveryMethod, HasAName) {
  EXPECT_EQ(polygonize_method_named(name_of(GetParam())), GetParam());
  EXPECT_FALSE(polygonize_method_named("guesswork").has_value());
}

std::string test_name(const testing::TestParamInfo<PolygonizeMethod>& method) {
  std::string name(name_of(method.param));
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Polygonize, EveryMethod,
                         testing::Values(PolygonizeMethod::marching_cubes, PolygonizeMethod::marching_tetrahedra,
                                         PolygonizeMethod::dual_contouring, PolygonizeMethod::adaptive),
                         test_name);

// f at the centroids of the triangles.
Eigen::ArrayXd at_centroids(const Mesh& mesh, const Field<3>& field) {
  Points<3> centroids(3, mesh.triangles.cols());
  for (Index t = 0; t < mesh.triangles.cols(); ++t) {
    const Eigen::Vector3i v = mesh.triangles.col(t);
    centroids.col(t) = (mesh.vertices.col(v[0]) + mesh.vertices.col(v[1]) + mesh.vertices.col(v[2])) / 3;
  }
  return field.evaluate(centroids).value;
}

double largest_value(const Mesh& mesh, const Field<3>& field) {
  return std::max(field.evaluate(mesh.vertices).value.cwiseAbs().maxCoeff(),
                  at_centroids(mesh, field).abs().maxCoeff());
}

double rms_value(const Mesh& mesh, const Field<3>& field) {
  return std::sqrt(at_centroids(mesh, field).square().mean());
}

PolygonizeOptions dual(int resolution) {
  return {.resolution = resolution, .method = PolygonizeMethod::dual_contouring};
}

// Crossings are known to 1e-4 of an edge and better, normals of planes exactly.
constexpr double crossing_error = 1e-4;

TEST(DualContouring, KeepsTheEdgesAndCornersOfABox) {
  const Point<3> half(0.7, 0.5, 0.4);
  const Implicit box = turned_box(half);
  for (const int resolution : {16, 33, 64}) {
    const double cell = 2 * half.norm() / resolution;
    EXPECT_GT(largest_value(polygonize(box, {.resolution = resolution}), box), 0.3 * cell);
    const Mesh mesh = polygonize(box, dual(resolution));
    EXPECT_LT(largest_value(mesh, box), crossing_error * cell);
    EXPECT_NEAR(volume(mesh), 8 * half.prod(), crossing_error * cell * 8 * half.squaredNorm());
  }
}

TEST(DualContouring, KeepsTheTipOfACone) {
  // Around the axis z, tip at height 1, opening as wide as high, base at 0.
  const Implicit cone(
      [](const Point<3>& p, Point<3>& g) {
        const Point<3> q = p - off_center;
        const double r = std::hypot(q[0], q[1]);
        const double side = (1 - q[2] - r) / std::sqrt(2);
        g = side < q[2] ? Point<3>(Point<3>(-q[0] / r, -q[1] / r, -1) / std::sqrt(2)) : Point<3>::UnitZ();
        return std::min(side, q[2]);
      },
      {{-1, -1, 0}, {1.1, 1.1, 1.1}});
  for (const int resolution : {13, 26, 52, 104}) {
    const double cell = 2.1 / resolution, tip = 1 + off_center[2];
    EXPECT_LT(polygonize(cone, {.resolution = resolution}).vertices.row(2).maxCoeff(), tip - 0.1 * cell);
    const Mesh mesh = polygonize(cone, dual(resolution));
    expect_closed_manifold(mesh);
    EXPECT_NEAR(mesh.vertices.row(2).maxCoeff(), tip, crossing_error * cell);
  }
}

// What is in two balls, or in the first and not in the second.
Implicit two_balls(bool difference) {
  return {[=](const Point<3>& p, Point<3>& g) {
            const Point<3> a = p - off_center, b = p - off_center - Point<3>(0.9, 0.3, 0);
            const double first = 1 - a.norm(), second = difference ? b.norm() - 1 : 1 - b.norm();
            g = first < second ? Point<3>(-a.normalized()) : Point<3>((difference ? 1 : -1) * b.normalized());
            return std::min(first, second);
          },
          cube(1.05), columns({off_center - (difference ? Point<3>(1, 0, 0) : Point<3>(0.049, 0.016, 0))})};
}

TEST(DualContouring, ConvergesWithOrderTwoUpToTheEdges) {
  std::vector<double> lens, blade;  // a blade thinner than a cell may lose bits of its edge: no order of the largest
  for (const int resolution : {8, 16, 32, 64, 128}) {
    lens.push_back(largest_value(polygonize(two_balls(false), dual(resolution)), two_balls(false)));
    blade.push_back(rms_value(polygonize(two_balls(true), dual(resolution)), two_balls(true)));
  }
  EXPECT_GT(observed_order(lens), 1.9);
  EXPECT_GT(observed_order(blade), 1.9);
  EXPECT_GT(largest_value(polygonize(two_balls(false), {.resolution = 128}), two_balls(false)), 10 * lens.back());
}

TEST(DualContouring, FoldsFewTrianglesOfARoughSurface) {
  // A sphere with bumps about three cells wide, whose tangent planes meet anywhere.
  const Implicit rough(
      [](const Point<3>& p, Point<3>& g) {
        constexpr double height = 0.06, frequency = 20;
        const Eigen::Array3d s = (frequency * p).array().sin(), c = (frequency * p).array().cos();
        g = -p.normalized() + height * frequency * Point<3>(c[0] * s[1] * s[2], s[0] * c[1] * s[2], s[0] * s[1] * c[2]);
        return 1 - p.norm() + height * s.prod();
      },
      cube(1.1));
  const Mesh mesh = polygonize(rough, dual(40));
  expect_closed_manifold(mesh);
  Index folded = 0;
  for (Index t = 0; t < mesh.triangles.cols(); ++t) {
    const Eigen::Vector3i v = mesh.triangles.col(t);
    const Point<3> a = mesh.vertices.col(v[0]), b = mesh.vertices.col(v[1]), c = mesh.vertices.col(v[2]);
    folded += (b - a).cross(c - a).dot(mesh.normals(Eigen::all, v).rowwise().sum()) < 0;
  }
  EXPECT_LT(folded, mesh.triangles.cols() / 100);  // nearly three times that when none is unfolded
}

TEST(DualContouring, PutsVerticesOnFacesWhereTwoLoopsMeetTwice) {
  Index added = 0;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    PolygonizeStatistics statistics;
    PolygonizeOptions options = lattice_of_noise(12);
    options.method = PolygonizeMethod::dual_contouring;
    options.statistics = &statistics;
    const Mesh cubes = polygonize(noise(12, seed), lattice_of_noise(12));
    const Mesh mesh = polygonize(noise(12, seed), options);
    EXPECT_EQ(topology(mesh).euler, topology(cubes).euler);
    EXPECT_EQ(topology(mesh).components, topology(cubes).components);
    added += statistics.center_vertices;
  }
  EXPECT_GT(added, 0);  // the case was met
}

PolygonizeOptions adaptive(int resolution, double tolerance = 0) {
  return {.resolution = resolution, .method = PolygonizeMethod::adaptive, .tolerance = tolerance};
}

TEST(AdaptivePolygonization, LeavesFewTrianglesOfABox) {
  const Point<3> half(0.7, 0.5, 0.4);
  const Mesh mesh = polygonize(turned_box(half), adaptive(64));
  expect_closed_manifold(mesh);
  EXPECT_LT(mesh.triangles.cols(), 100);  // of 22 540; twelve would do
  EXPECT_NEAR(volume(mesh), 8 * half.prod(), crossing_error);
}

TEST(AdaptivePolygonization, KeepsTheToleranceAndTheTopology) {
  for (const double tolerance : {1e-3, 4e-3, 16e-3}) {
    const Implicit solid = two_balls(false);
    const Mesh mesh = polygonize(solid, adaptive(128, tolerance / solid.bounds().diagonal()));
    expect_closed_manifold(mesh);
    EXPECT_EQ(topology(mesh).euler, 2);
    EXPECT_LT(largest_value(mesh, solid), 1.2 * tolerance);  // a bound of root mean squares is not strict
    EXPECT_GT(largest_value(mesh, solid), 0.2 * tolerance);  // and not wasted
  }
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    PolygonizeOptions options = lattice_of_noise(12);
    options.method = PolygonizeMethod::adaptive;
    options.tolerance = 0.1;
    const Mesh cubes = polygonize(noise(12, seed), lattice_of_noise(12)), mesh = polygonize(noise(12, seed), options);
    EXPECT_EQ(topology(mesh).euler, topology(cubes).euler);
    EXPECT_EQ(topology(mesh).components, topology(cubes).components);
    EXPECT_LT(mesh.triangles.cols(), cubes.triangles.cols());
  }
}

// A torus so thin that its cells are small, joined to a ball that is nearly flat in them.
Implicit ring_in_ball() {
  return {[](const Point<3>& p, Point<3>& g) {
            const double q = std::hypot(p[0], p[1]), tube = std::hypot(q - 1, p[2]);
            const double ring = 0.06 - tube, ball = 0.97 - p.norm();
            g = ball > ring ? Point<3>(-p / p.norm())
                            : Point<3>(-(q - 1) * p[0] / (q * tube), -(q - 1) * p[1] / (q * tube), -p[2] / tube);
            return std::max(ring, ball);
          },
          cube(1.06), columns({{1.06, 0, 0}})};
}

TEST(AdaptivePolygonization, NeedsFewerTrianglesForTheSameError) {
  const Mesh cubes = polygonize(ring_in_ball(), {.resolution = 100});
  const double error = rms_value(cubes, ring_in_ball());
  const Mesh mesh = polygonize(ring_in_ball(), adaptive(200, 1.5 * error / ring_in_ball().bounds().diagonal()));
  expect_closed_manifold(mesh);
  EXPECT_LT(rms_value(mesh, ring_in_ball()), error);
  EXPECT_LT(mesh.triangles.cols(), cubes.triangles.cols() / 2);
}

TEST(AdaptivePolygonization, RefusesANegativeTolerance) {
  const std::string message =
      "polygonize: tolerance = -1: must be a fraction of the diagonal above 0, or 0 for a tenth of a cell";
  EXPECT_EQ(invalid_input_message([] { (void)polygonize(sphere(1), adaptive(16, -1)); }), message);
}

TEST(MarchingTetrahedra, CutsAllFourteenEdgesOfALoneCorner) {
  const double radius = 0.03;  // smaller than a cell, around a corner with 14 edges
  const Mesh mesh =
      polygonize(sphere(radius, Point<3>::Zero()),
                 {.resolution = 1, .method = PolygonizeMethod::marching_tetrahedra, .bounds = cube(4 * radius)});
  expect_closed_manifold(mesh);
  EXPECT_EQ(mesh.vertices.cols(), 14);
  EXPECT_EQ(mesh.triangles.cols(), 24);
  EXPECT_LT(largest_distance_to_sphere(mesh, radius, Point<3>::Zero()), 1e-9 * radius);
}

}  // namespace
}  // namespace csrbf::polygonize_method_test
