#include "csrbf/implicit/polygonize.hpp"

#include "csrbf/core/parallel.hpp"
#include "implicit/polygonize_fields.hpp"

#include <Eigen/Geometry>

namespace csrbf::polygonize_test {
namespace {

TEST(Polygonize, HalfSpaceInABoxIsClosedByFlatCaps) {
  const Implicit half_space([](const Point<3>& p, Point<3>& g) { return g = {0, 0, -1}, 0.15 - p[2]; }, cube(1));
  const Box<3> bounds{{-1, -0.5, -0.75}, {1, 0.5, 0.75}};
  const Mesh mesh = polygonize(half_space, {.resolution = 20, .bounds = bounds});
  expect_closed_manifold(mesh);
  EXPECT_EQ(topology(mesh).euler, 2);
  const double cell = 0.1;
  EXPECT_NEAR(mesh.vertices.row(0).maxCoeff(), 1 + edge_margin * cell, 1e-12);
  EXPECT_NEAR(mesh.vertices.row(0).minCoeff(), -1 - edge_margin * cell, 1e-12);
  EXPECT_NEAR(mesh.vertices.row(2).maxCoeff(), 0.15, 1e-12);
  const double margin_volume = edge_margin * cell * (2 * 2 * 1 + 2 * 0.9 * 2 + 2 * 0.9 * 1);  // caps stand out by it
  EXPECT_NEAR(volume(mesh), 2 * 1 * 0.9, margin_volume);
}

TEST(Polygonize, SolidThatFillsItsBoxBecomesTheBox) {
  const Implicit everywhere([](const Point<3>&, Point<3>& g) { return g.setZero(), 1.0; }, cube(1));
  const Mesh mesh = polygonize(everywhere, {.resolution = 8, .bounds = cube(1)});
  expect_closed_manifold(mesh);
  EXPECT_EQ(topology(mesh).euler, 2);
  EXPECT_EQ(mesh.vertices.cols(), 6 * 9 * 9);  // one above every corner of the six sides
  EXPECT_NEAR(volume(mesh), 8, 8 * 3 * edge_margin * 0.25 * 1.01);
  for (Index i = 0; i < mesh.normals.cols(); ++i) EXPECT_EQ(mesh.normals.col(i).cwiseAbs().sum(), 1);
}

const Implicit filled([](const Point<3>&, Point<3>& g) { return g.setZero(), 1.0; }, {{-1, 2, 0.5}, {1, 3, 1.04}});

// Cells of 0.1: 20 x 10 x 6, the last ones by rounding up.
TEST(Polygonize, LatticeHasFourCellsMoreOnEverySideOfTheBoundsOfTheField) {
  const Mesh mesh = polygonize(filled, {.resolution = 20});
  const double margin = edge_margin * 0.1;
  const Point<3> half = (Point<3>(10, 5, 3).array() + 4) * 0.1 + margin;
  EXPECT_LT((mesh.vertices.rowwise().maxCoeff() - (filled.bounds().center() + half)).norm(), 1e-12);
  EXPECT_LT((mesh.vertices.rowwise().minCoeff() - (filled.bounds().center() - half)).norm(), 1e-12);
  EXPECT_EQ(mesh.vertices.cols(), 2 * (29 * 19 + 19 * 15 + 15 * 29));
}

TEST(Polygonize, GivenBoundsAreDividedIntoWholeCellsOfAboutTheSize) {
  const auto vertices = [](int x, int y, int z) {
    return Index{2} * ((x + 1) * (y + 1) + (y + 1) * (z + 1) + (z + 1) * (x + 1));
  };
  const Point<3> lo(7, 8, 9);
  for (const auto& [extent, cells] : {std::pair{Point<3>(2, 1, 0.54), Eigen::Array3i(20, 10, 5)},
                                      {Point<3>(0.56, 4, 0.01), Eigen::Array3i(6, 40, 1)}}) {
    const Box<3> bounds{lo, lo + extent};
    const Mesh mesh = polygonize(filled, {.resolution = 20, .bounds = bounds});
    const Point<3> margin = edge_margin * extent.cwiseQuotient(cells.matrix().cast<double>());
    EXPECT_LT((mesh.vertices.rowwise().minCoeff() - (bounds.lo - margin)).norm(), 1e-12);
    EXPECT_LT((mesh.vertices.rowwise().maxCoeff() - (bounds.hi + margin)).norm(), 1e-12);
    EXPECT_EQ(mesh.vertices.cols(), vertices(cells[0], cells[1], cells[2]));
  }
}

TEST(Polygonize, ChoosesTheResolutionByTheDetailOfTheField) {
  struct Detailed : Implicit {
    explicit Detailed(double feature_size) : Implicit(sphere(1)), feature_size_(feature_size) {}
    [[nodiscard]] double feature_size() const override { return feature_size_; }
    double feature_size_;
  };
  EXPECT_EQ(automatic_resolution(Detailed(2.0 / 100.5)), 101);
  EXPECT_EQ(automatic_resolution(Detailed(2.0 / 31)), 32);
  EXPECT_EQ(automatic_resolution(Detailed(1e-9)), 1024);
  EXPECT_EQ(automatic_resolution(Detailed(0)), 128);
  EXPECT_TRUE(identical(polygonize(Detailed(0.04)), polygonize(sphere(1), {.resolution = 50})));
}

TEST(Polygonize, TakesOptionsAtTheEndsOfTheirRanges) {
  const Box<3> piece{{0.99, -0.01, -0.01}, {1.02, 0.01, 0.01}};
  EXPECT_EQ(topology(polygonize(sphere(1), {.resolution = 4096, .bounds = piece})).euler, 2);
}

TEST(Polygonize, SphereSmallerThanACellAroundACornerIsAnOctahedron) {
  const double radius = 0.03;
  const Implicit small = sphere(radius, Point<3>::Zero());
  const Mesh mesh = polygonize(small, {.resolution = 1, .bounds = cube(4 * radius)});  // cells of 2 radii
  expect_closed_manifold(mesh);
  EXPECT_EQ(mesh.vertices.cols(), 6);
  EXPECT_EQ(mesh.triangles.cols(), 8);
  EXPECT_LT(largest_distance_to_sphere(mesh, radius, Point<3>::Zero()), 1e-9 * radius);
}

TEST(Polygonize, CornersExactlyOnTheSurfaceAreInsideAndGiveNoDegenerateTriangles) {
  // 102 integer points lie on the sphere of radius 9, as (9, 0, 0), (8, 4, 1), (7, 4, 4) and (6, 6, 3).
  const Implicit centered([](const Point<3>& p, Point<3>& g) { return g = -2 * p, 81 - p.squaredNorm(); }, cube(9));
  const Mesh mesh = polygonize(centered, {.resolution = 18, .bounds = cube(13)});
  expect_closed_manifold(mesh);
  EXPECT_EQ(topology(mesh).euler, 2);
  EXPECT_LT(largest_distance_to_sphere(mesh, 9, Point<3>::Zero()), 1e-5);
  const double smallest = 0.01 * std::pow(edge_margin, 2);  // a triangle as small as the margin, but not a needle
  EXPECT_GT(areas(mesh).minCoeff(), smallest);
}

TEST(Polygonize, LevelShiftsTheField) {
  const Implicit inner = sphere(1);
  const Mesh mesh = polygonize(inner, {.resolution = 32, .level = -0.25});
  const double radius = std::sqrt(1.5);  // (1 - r^2) / 2 = -1/4
  EXPECT_LT(largest_distance_to_sphere(mesh, radius, off_center), 1e-6);
}

TEST(Polygonize, LinearFieldNeedsNoRefinement) {
  const Point<3> n = Point<3>(1, 2, 3).normalized();
  const Implicit plane([=](const Point<3>& p, Point<3>& g) { return g = -n, 0.1 - n.dot(p); }, cube(1));
  const Mesh mesh = polygonize(plane, {.resolution = 16, .bounds = cube(1), .refine = false});
  expect_closed_manifold(mesh);
  EXPECT_LT((n.transpose() * mesh.vertices).maxCoeff(), 0.1 + 1e-12 + 1e-3 * 0.125);
}

TEST(Polygonize, ResultDoesNotDependOnTheNumberOfThreads) {
  const Implicit field = torus(1, 0.35);
  const Implicit rough = noise(20, 7);
  std::vector<Mesh> smooth_meshes;
  std::vector<Mesh> rough_meshes;
  for (const int threads : {1, 2, 3}) {
    set_thread_count(threads);
    smooth_meshes.push_back(polygonize(field, {.resolution = 90}));
    rough_meshes.push_back(polygonize(rough, lattice_of_noise(20)));
  }
  set_thread_count(0);
  for (std::size_t i = 1; i < 3; ++i) {
    EXPECT_TRUE(identical(smooth_meshes[0], smooth_meshes[i]));
    EXPECT_TRUE(identical(rough_meshes[0], rough_meshes[i]));
  }
}

TEST(Polygonize, ResultDoesNotDependOnWhichSeedFindsTheSurface) {
  const Implicit field = sphere(1);
  const Mesh first = polygonize(field, {.resolution = 50});
  const Points<3> others = columns({off_center + Point<3>(0, 1, 0), off_center - Point<3>(0, 0, 1)});
  EXPECT_TRUE(identical(first, polygonize(field, {.resolution = 50, .seeds = others})));
}

TEST(Polygonize, ScaleOfSpaceAndValuesDoesNotMatter) {
  const Mesh unit = polygonize(sphere(1), {.resolution = 33});
  for (const double scale : {0x1p-100, 0x1p100}) {  // powers of two: every operation scales exactly
    const Implicit scaled(
        [=](const Point<3>& p, Point<3>& g) {
          const double f = ball(p / scale, off_center, 1, g) / scale;
          g /= scale * scale;
          return f;
        },
        {(off_center.array() - 1) * scale, (off_center.array() + 1) * scale},
        columns({scale * (off_center + Point<3>(1, 0, 0))}));
    const Mesh mesh = polygonize(scaled, {.resolution = 33});
    EXPECT_TRUE(mesh.triangles == unit.triangles);
    EXPECT_LT((mesh.vertices / scale - unit.vertices).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST(Polygonize, NormalsAreOutwardUnitVectors) {
  const Mesh mesh = polygonize(sphere(1), {.resolution = 64});
  const Points<3> expected = (mesh.vertices.colwise() - off_center).colwise().normalized();
  const double curvature_times_last_step = 0.05 * 2 / 64;
  EXPECT_LT((mesh.normals - expected).colwise().norm().maxCoeff(), curvature_times_last_step);
}

TEST(Polygonize, NormalsComeFromTheTrianglesWhereTheGradientVanishes) {
  const Implicit step([](const Point<3>& p, Point<3>& g) { return g.setZero(), p.norm() < 1 ? 1.0 : -1.0; }, cube(1));
  const Mesh mesh = polygonize(step, {.resolution = 24});
  expect_closed_manifold(mesh);
  EXPECT_LT((mesh.normals.colwise().norm().array() - 1).abs().maxCoeff(), 1e-12);
  const Eigen::RowVectorXd outward = (mesh.normals.array() * mesh.vertices.array()).colwise().sum();
  EXPECT_GT(outward.minCoeff(), 0);
}

TEST(Polygonize, NormalsAreMeansOfTheTrianglesAroundWhereSomeGradientsVanish) {
  const Implicit half_blind(
      [](const Point<3>& p, Point<3>& g) {
        const double f = ball(p, off_center, 1, g);
        if (p[0] > 0.1) g.setZero();
        return f;
      },
      sphere(1).bounds());
  const Mesh mesh = polygonize(half_blind, {.resolution = 12});
  Points<3> sum = Points<3>::Zero(3, mesh.vertices.cols());
  for (Index t = 0; t < mesh.triangles.cols(); ++t) {
    const Eigen::Vector3i v = mesh.triangles.col(t);
    const Point<3> a = mesh.vertices.col(v[0]);
    const Point<3> area = (mesh.vertices.col(v[1]) - a).cross(mesh.vertices.col(v[2]) - a);
    for (const int corner : v) sum.col(corner) += area;
  }
  for (Index i = 0; i < sum.cols(); ++i) {
    if (mesh.vertices(0, i) < 0.15) continue;  // gradients of estimates on the other side count
    EXPECT_LT((mesh.normals.col(i) - sum.col(i).normalized()).norm(), 1e-12);
  }
}

TEST(Polygonize, WithoutNormalsThereAreNoneAndTheSurfaceIsTheSame) {
  const Mesh with = polygonize(sphere(1), {.resolution = 40});
  const Mesh without = polygonize(sphere(1), {.resolution = 40, .normals = false});
  EXPECT_EQ(without.normals.cols(), 0);
  EXPECT_TRUE(without.triangles == with.triangles);
  EXPECT_LT((without.vertices - with.vertices).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(Polygonize, VerticesFindTheSurfaceOfAFieldWithKinks) {
  const Point<3> first(-0.4, 0.01, 0.02);
  const Point<3> second(0.37, -0.03, 0.05);
  const Implicit pair(
      [=](const Point<3>& p, Point<3>& g) {
        const bool is_first = (p - first).norm() < (p - second).norm();
        const Point<3> d = p - (is_first ? first : second);
        g = -d / d.norm();
        return 0.6 - d.norm();
      },
      cube(1));
  const Mesh mesh = polygonize(pair, {.resolution = 50});
  expect_closed_manifold(mesh);
  EXPECT_LT(pair.evaluate(mesh.vertices).value.cwiseAbs().maxCoeff(), 1e-4 * 2 / 50);
}

TEST(Polygonize, NeedsFewEvaluationsPerVertex) {
  PolygonizeStatistics statistics;
  const Mesh mesh = polygonize(torus(1, 0.4), {.resolution = 128, .statistics = &statistics});
  const auto evaluations = static_cast<double>(statistics.values + statistics.gradients);
  EXPECT_LT(evaluations / static_cast<double>(mesh.vertices.cols()), 3.2);
  EXPECT_GT(statistics.waves, 1);
  EXPECT_EQ(statistics.center_vertices, 0);
}

TEST(Polygonize, ReportsGrowingProgressAndCanBeCancelled) {
  double last = 0;
  const auto watch = [&](std::string_view stage, double fraction) {
    EXPECT_EQ(stage, "polygonize");
    EXPECT_GE(fraction, last);
    last = fraction;
    return true;
  };
  (void)polygonize(sphere(1), {.resolution = 40, .progress = watch});
  EXPECT_EQ(last, 1);
  int calls = 0;
  const auto stop = [&](std::string_view, double) { return ++calls < 5; };
  EXPECT_THROW((void)polygonize(sphere(1), {.resolution = 40, .progress = stop}), Cancelled);
}

// Slope of log(error) over four halvings.
double observed_order(const std::vector<double>& errors) {
  return std::log2(errors.front() / errors.back()) / static_cast<double>(errors.size() - 1);
}

TEST(Polygonize, AreaAndVolumeConvergeWithOrderTwo) {
  std::vector<double> area_errors;
  std::vector<double> volume_errors;
  for (const int resolution : {12, 24, 48, 96, 192}) {
    const Mesh mesh = polygonize(torus(1, 0.4), {.resolution = resolution});
    area_errors.push_back(std::abs(areas(mesh).sum() - 4 * pi * pi * 0.4));
    volume_errors.push_back(std::abs(volume(mesh) - 2 * pi * pi * 0.16));
  }
  EXPECT_GT(observed_order(area_errors), 1.9);
  EXPECT_GT(observed_order(volume_errors), 1.9);
}

TEST(Polygonize, VerticesAreOnTheSurfaceWithRefinementAndOfOrderTwoWithout) {
  std::vector<double> errors;
  for (const int resolution : {8, 16, 32, 64, 128}) {
    const Mesh chord = polygonize(sphere(1), {.resolution = resolution, .refine = false});
    errors.push_back(largest_distance_to_sphere(chord, 1, off_center));
    const Mesh refined = polygonize(sphere(1), {.resolution = resolution});
    EXPECT_LT(largest_distance_to_sphere(refined, 1, off_center), 1e-6);
  }
  EXPECT_GT(observed_order(errors), 1.9);
}

template <class Error>
void expect_error(const Field<3>& field, const PolygonizeOptions& options, const std::string& message) {
  try {
    (void)polygonize(field, options);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(message), std::string::npos) << error.what();
  }
}

TEST(Polygonize, RefusesOptionsOutsideTheirRange) {
  const Implicit field = sphere(1);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expect_error<InvalidInput>(field, {.resolution = -1}, "polygonize: resolution = -1: ");
  expect_error<InvalidInput>(field, {.resolution = 4097}, "polygonize: resolution = 4097: ");
  expect_error<InvalidInput>(field, {.method = static_cast<PolygonizeMethod>(9)}, "polygonize: method = 9: ");
  expect_error<InvalidInput>(field, {.tolerance = nan}, "polygonize: tolerance = nan: ");
  expect_error<InvalidInput>(field, {.level = nan}, "polygonize: level = nan: ");
  expect_error<InvalidInput>(field, {.bounds = {{0, 0, 0}, {1, 1, 0}}}, "polygonize: bounds = 1 x 1 x 0: ");
  expect_error<InvalidInput>(field, {.bounds = {{0, 0, 0}, {-1, 1, 1}}}, "polygonize: bounds");
  expect_error<InvalidInput>(field, {.bounds = cube(nan)}, "polygonize: bounds");
  expect_error<InvalidInput>(field, {.bounds = cube(1e9)}, "polygonize: bounds / cell size");
  expect_error<InvalidInput>(field, {.seeds = Points<3>::Constant(3, 1, nan)}, "polygonize: seeds");
}

TEST(Polygonize, RefusesAFieldWithoutBoundsUnlessTheyAreGiven) {
  const Implicit field([](const Point<3>& p, Point<3>& g) { return ball(p, Point<3>::Zero(), 1, g); }, Box<3>{});
  expect_error<InvalidInput>(field, {}, "polygonize: field.bounds()");
  EXPECT_EQ(topology(polygonize(field, {.resolution = 20, .bounds = cube(1.3)})).euler, 2);
}

TEST(Polygonize, FailsWhereThereIsNoSurface) {
  expect_error<SolverFailure>(sphere(1), {.resolution = 16, .level = 10}, "no zero crossing");
  expect_error<SolverFailure>(sphere(1), {.resolution = 16, .seeds = off_center}, "near any of 1 seeds");
  const Implicit nothing([](const Point<3>&, Point<3>& g) { return g.setZero(), -1.0; }, cube(1));
  expect_error<SolverFailure>(nothing, {.resolution = 16}, "in the scanned box; check the level");
  expect_error<SolverFailure>(nothing, {.resolution = 1}, "resolution = 1 is too coarse to find a surface; raise it");
}

TEST(Polygonize, FailsWithThePositionWhereTheFieldIsNotFinite) {
  const auto value = [](const Point<3>& p, Point<3>& g) {
    const double f = ball(p, Point<3>::Zero(), 1, g);
    return p[2] > 0.5 ? std::numeric_limits<double>::quiet_NaN() : f;
  };
  const Implicit field(value, cube(1), columns({{1, 0, 0}}));
  expect_error<SolverFailure>(field, {.resolution = 20}, "polygonize: the field is nan at (");
}

}  // namespace
}  // namespace csrbf::polygonize_test
