#include "csrbf/surface/reconstruct.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/implicit/polygonize.hpp"
#include "csrbf/io/model.hpp"
#include "csrbf/surface/trim.hpp"
#include "surface/surface_testing.hpp"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <filesystem>
#include <numbers>
#include <random>

namespace csrbf::reconstruct_test {
namespace {

// n points of a Fibonacci lattice on the unit sphere with outward normals.
PointCloud sphere(Index n, double radius = 1, const Point<3>& center = Point<3>::Zero()) {
  PointCloud cloud;
  cloud.normals.resize(3, n);
  for (Index i = 0; i < n; ++i) {
    const double z = (2.0 * static_cast<double>(i) + 1) / static_cast<double>(n) - 1, r = std::sqrt(1 - z * z);
    const double t = static_cast<double>(i) * std::numbers::pi * (3 - std::sqrt(5.0));
    cloud.normals.col(i) << r * std::cos(t), r * std::sin(t), z;
  }
  cloud.points = (radius * cloud.normals).colwise() + center;
  return cloud;
}

PointCloud torus(Index n) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> angle(0, 2 * std::numbers::pi), unit(0, 1);
  PointCloud cloud;
  cloud.points.resize(3, n);
  cloud.normals.resize(3, n);
  for (Index i = 0; i < n;) {
    const double u = angle(random), v = angle(random);
    if (1.35 * unit(random) > 1 + 0.35 * std::cos(v)) continue;
    cloud.normals.col(i) << std::cos(v) * std::cos(u), std::cos(v) * std::sin(u), std::sin(v);
    cloud.points.col(i) = Point<3>(std::cos(u), std::sin(u), 0) + 0.35 * cloud.normals.col(i);
    ++i;
  }
  return cloud;
}

double torus_distance(const Point<3>& p) {
  return std::abs(std::hypot(std::hypot(p[0], p[1]) - 1, p[2]) - 0.35);
}

Mesh mesh_of(const PointCloud& cloud, const ReconstructOptions& options = {}) {
  return polygonize(*reconstruct(cloud, options).field);
}

template <class Error>
void expect_error(const PointCloud& cloud, const ReconstructOptions& options, const std::string& part) {
  try {
    (void)reconstruct(cloud, options);
    FAIL() << "no error; expected: " << part;
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

constexpr double sphere_accuracy = 1e-3;  // of the radius: a few per mille of the spacing, for 2000 points

double largest_sphere_error(const Mesh& mesh, double radius = 1) {
  return (mesh.vertices.colwise().norm().array() / radius - 1).abs().maxCoeff();
}

TEST(Reconstruct, MakesASphereOfSphereSamples) {
  const Mesh mesh = mesh_of(sphere(2000));
  expect_closed(mesh, 1, 2);
  EXPECT_LT(largest_sphere_error(mesh), sphere_accuracy);
}

TEST(Reconstruct, KeepsTwoSpheresApart) {
  expect_closed(mesh_of(joined(sphere(2000), sphere(2000, 1, {2.3, 0, 0}))), 2, 4);
}

TEST(Reconstruct, ConvergesOnATorusAtThirdOrderInTheSpacing) {
  constexpr double quadric_order = 3;
  std::vector<double> error;
  for (const Index n : {4000, 16000, 64000}) {
    const Mesh mesh = mesh_of(torus(n));
    expect_closed(mesh, 1, 0);
    double sum = 0;
    for (Index v = 0; v < mesh.vertices.cols(); ++v) sum += torus_distance(mesh.vertices.col(v));
    error.push_back(sum / static_cast<double>(mesh.vertices.cols()));
  }
  EXPECT_GT(std::log2(error[0] / error[1]), quadric_order - 0.1);
  EXPECT_GT(std::log2(error[1] / error[2]), quadric_order - 0.1);
}

TEST(Reconstruct, DoesNotDependOnTheNumberOfThreads) {
  const PointCloud cloud = torus(8000);
  set_thread_count(1);
  const Mesh one = mesh_of(cloud);
  set_thread_count(3);
  const Mesh three = mesh_of(cloud);
  set_thread_count(0);
  EXPECT_EQ(one.vertices, three.vertices);
  EXPECT_EQ(one.triangles, three.triangles);
}

TEST(Reconstruct, MovesTurnsAndScalesWithTheCloud) {
  constexpr double usual_error = 1e-4;    // a four hundredth of the spacing of 0.04
  constexpr double largest_error = 4e-3;  // a tenth: where the samples leave a gap
  const PointCloud cloud = torus(8000);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Point<3>(1, 2, 3).normalized()).toRotationMatrix();
  for (const double scale : {1e-30, 1e-3, 1.0, 1e30}) {
    PointCloud image;
    image.points = scale * ((turn * cloud.points).colwise() + Point<3>(4, -5, 6));
    image.normals = turn * cloud.normals;
    const Mesh mesh = mesh_of(image);
    expect_closed(mesh, 1, 0);
    const Points<3> back = turn.transpose() * ((mesh.vertices / scale).colwise() - Point<3>(4, -5, 6));
    Eigen::ArrayXd error(back.cols());
    for (Index v = 0; v < back.cols(); ++v) error[v] = torus_distance(back.col(v));
    EXPECT_LT(error.mean(), usual_error);
    EXPECT_LT(error.maxCoeff(), largest_error);
  }
}

TEST(Reconstruct, TakesNormalsOffTheSurfaceAsWell) {
  const Mesh mesh = mesh_of(sphere(2000), {.normal_rows = NormalRows::off_surface});
  expect_closed(mesh, 1, 2);
  EXPECT_LT(largest_sphere_error(mesh), sphere_accuracy);
}

TEST(Reconstruct, TakesPointsInVectors) {
  const PointCloud cloud = sphere(500);
  std::vector<std::array<double, 3>> points, normals;
  for (Index i = 0; i < cloud.size(); ++i) {
    points.push_back({cloud.points(0, i), cloud.points(1, i), cloud.points(2, i)});
    normals.push_back({cloud.normals(0, i), cloud.normals(1, i), cloud.normals(2, i)});
  }
  const Point<3> p(0.3, -0.2, 0.8);
  EXPECT_EQ((*reconstruct(points, normals).field)(p), (*reconstruct(cloud).field)(p));
  normals.pop_back();
  EXPECT_THROW((void)reconstruct(points, normals), InvalidInput);
}

TEST(Reconstruct, KeepsTheBudgetOfCenters) {
  const Reconstruction result = reconstruct(torus(8000), {.centers = 500});
  EXPECT_EQ(result.report.centers, 500);
  EXPECT_LT(result.report.rms_distance, 2e-3);
  expect_closed(polygonize(*result.field), 1, 0);
}

TEST(Reconstruct, KeepsTheTolerance) {
  const PointCloud cloud = torus(8000);
  Index last = 0;
  for (const double tolerance : {1e-3, 1e-5}) {
    const ReconstructReport report = reconstruct(cloud, {.tolerance = tolerance}).report;
    EXPECT_LE(report.max_distance, tolerance);
    ASSERT_TRUE(report.composite);
    EXPECT_GT(report.composite->patches, last) << "a smaller tolerance takes more patches";
    last = report.composite->patches;
  }
}

TEST(Reconstruct, EstimatesNormalsThatAreNotGiven) {
  PointCloud cloud = sphere(2000);
  cloud.normals.resize(3, 0);
  const Reconstruction result = reconstruct(cloud);
  EXPECT_EQ(result.report.normals, NormalSource::estimated);
  const Mesh mesh = polygonize(*result.field);
  expect_closed(mesh, 1, 2);
  EXPECT_LT(largest_sphere_error(mesh), sphere_accuracy);
}

TEST(Reconstruct, FillsMissingNormals) {
  PointCloud cloud = sphere(2000);
  for (Index i = 0; i < cloud.size(); i += 10) cloud.normals.col(i).setZero();
  cloud.normals(0, 5) = std::numeric_limits<double>::quiet_NaN();
  const Reconstruction result = reconstruct(cloud);
  ASSERT_EQ(result.report.warnings.size(), 1U);
  EXPECT_EQ(result.report.warnings[0], "201 missing normals estimated");
  expect_closed(polygonize(*result.field), 1, 2);
}

TEST(Reconstruct, EstimatesAllNormalsWhenAllAreZero) {
  PointCloud cloud = sphere(2000);
  cloud.normals.setZero();
  expect_closed(mesh_of(cloud), 1, 2);
}

TEST(Reconstruct, TurnsAFlippedPatchOfNormals) {
  PointCloud cloud = sphere(3000);
  for (Index i = 0; i < cloud.size(); ++i)
    if (cloud.points(0, i) > 0.5) cloud.normals.col(i) *= -1;
  const Reconstruction result = reconstruct(cloud);
  EXPECT_EQ(result.report.normals, NormalSource::reoriented);
  expect_closed(polygonize(*result.field), 1, 2);
}

TEST(Reconstruct, MergesDuplicatesAndDropsPointsThatAreNotFinite) {
  PointCloud cloud = joined(sphere(2000), sphere(2000));
  cloud.points(1, 7) = std::numeric_limits<double>::quiet_NaN();
  cloud.points(2, 9) = std::numeric_limits<double>::infinity();
  const Reconstruction result = reconstruct(cloud);
  EXPECT_EQ(result.report.points_used, 2000);
  EXPECT_EQ(result.report.warnings.size(), 2U);
  expect_closed(polygonize(*result.field), 1, 2);
}

TEST(Reconstruct, SurvivesOutliers) {
  PointCloud stray;
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  stray.points = Points<3>::NullaryExpr(3, 30, [&] { return uniform(random); });
  stray.normals = Points<3>::NullaryExpr(3, 30, [&] { return uniform(random); });
  const PointCloud cloud = joined(sphere(3000), stray);
  const Reconstruction result = reconstruct(cloud);
  const Mesh mesh = keep_components_with_data(polygonize(*result.field), cloud.points(Eigen::all, result.source)).mesh;
  EXPECT_TRUE(topology(mesh).watertight());
  Index good = 0;
  for (const Index i : result.source) good += i < 3000 ? 1 : 0;
  EXPECT_GE(good, 2990);
  Eigen::ArrayXd error = (mesh.vertices.colwise().norm().array() - 1).abs().transpose();
  std::sort(error.begin(), error.end());
  EXPECT_LT(error[error.size() / 2], sphere_accuracy);
}

TEST(Reconstruct, ClosesAHemisphereThatTrimOpensAgain) {
  const PointCloud whole = sphere(4000);
  std::vector<Index> upper;
  for (Index i = 0; i < whole.size(); ++i)
    if (whole.points(2, i) > 0) upper.push_back(i);
  PointCloud cloud;
  cloud.points = whole.points(Eigen::all, upper);
  cloud.normals = whole.normals(Eigen::all, upper);
  const Mesh closed = mesh_of(cloud);
  expect_closed(closed, 1, 2);
  const Mesh open = trim(closed, cloud.points, 3);
  const Topology t = topology(open);
  EXPECT_TRUE(t.manifold());
  EXPECT_GT(t.boundary_edges, 0);
  EXPECT_EQ(t.euler, 1) << "a disc";
}

TEST(Reconstruct, ClosesAPlane) {
  PointCloud cloud;
  cloud.points = Points<3>::Zero(3, 900);
  for (Index i = 0; i < 900; ++i) cloud.points.col(i) << static_cast<double>(i % 30), static_cast<double>(i / 30), 0;
  expect_closed(mesh_of(cloud), 1, 2);
}

TEST(Reconstruct, MakesSomethingOfFivePoints) {
  PointCloud cloud;
  cloud.points.resize(3, 5);
  cloud.points << 0, 1, 0, 0, 1, 0, 0, 1, 0, 1, 0, 0, 0, 1, 1;
  EXPECT_TRUE(topology(mesh_of(cloud)).watertight());
}

TEST(Reconstruct, IsTheSameFromItsFile) {
  const Reconstruction result = reconstruct(torus(3000));
  const std::string path = (std::filesystem::temp_directory_path() / "csrbf_reconstruct_test.csrbf").string();
  write_model(path, *result.field);
  const auto again = read_model(path);
  std::filesystem::remove(path);
  const Points<3> x = 2 * Points<3>::Random(3, 500);
  const Jet<3> a = result.field->evaluate(x, Derivatives::hessian), b = again->evaluate(x, Derivatives::hessian);
  EXPECT_EQ(a.value, b.value);
  EXPECT_EQ(a.gradient, b.gradient);
  EXPECT_EQ(a.hessian, b.hessian);
}

TEST(Reconstruct, ReportsProgressAndStopsWhenAsked) {
  int calls = 0;
  (void)reconstruct(sphere(2000), {.progress = [&](std::string_view, double fraction) {
                      ++calls;
                      return fraction >= 0 && fraction <= 1;
                    }});
  EXPECT_GT(calls, 4);
  EXPECT_THROW((void)reconstruct(sphere(2000), {.progress = [](std::string_view, double) { return false; }}),
               Cancelled);
}

TEST(Reconstruct, SaysWhatIsWrong) {
  const PointCloud good = sphere(500);
  PointCloud line;
  line.points = Point<3>(1, 2, 3) * Eigen::RowVectorXd::LinSpaced(50, 0, 1);
  PointCloud same;
  same.points = Points<3>::Ones(3, 50);
  PointCloud without = good;
  without.normals.resize(3, 0);
  PointCloud few = good;
  few.normals.resize(3, 10);
  expect_error<InvalidInput>({}, {}, "points = 0: too few distinct finite points");
  expect_error<InvalidInput>(same, {}, "points = 1: too few distinct finite points");
  expect_error<InvalidInput>(line, {}, "all lie on one line");
  expect_error<InvalidInput>(without, {.normals = Normals::file}, "the input has no normals");
  expect_error<InvalidInput>(few, {}, "normals = 10: must be one per point");
  expect_error<InvalidInput>(good, {.method = "magic"}, "method = magic: unknown");
  expect_error<InvalidInput>(good, {.centers = -1}, "centers = -1: must be positive");
  expect_error<InvalidInput>(good, {.tolerance = -1}, "tolerance = -1: must be a fraction");
  expect_error<InvalidInput>(good, {.tolerance = std::nan("")}, "tolerance = nan");
  expect_error<InvalidInput>(good, {.smoothing = -1}, "smoothing = -1: must not be negative");
}

TEST(Reconstruct, SaysWhenAToleranceCannotBeReached) {
  PointCloud cloud = sphere(2000);
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise(0, 0.02);
  for (Index i = 0; i < cloud.size(); ++i) cloud.points.col(i) *= 1 + noise(random);
  expect_error<SolverFailure>(cloud, {.tolerance = 1e-9}, "cannot be reached");
}

}  // namespace
}  // namespace csrbf::reconstruct_test
