#include "csrbf/implicit/compare.hpp"

#include "csrbf/core/parallel.hpp"
#include "implicit/mesh_testing.hpp"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

namespace csrbf::compare_test {
namespace {

constexpr double rounding = 1e-12;
constexpr double rounding_deg = 1e-9;
// Where two triangles are equally close rounding chooses whose normal counts.
constexpr double tied_normals = 0.01;

Mesh transformed(Mesh mesh, double scale, const Eigen::Matrix3d& rotation, const Point<3>& shift) {
  mesh.vertices = ((scale * rotation * mesh.vertices).colwise() + shift).eval();
  return mesh;
}

Mesh inverted(Mesh mesh) {
  mesh.triangles.row(1).swap(mesh.triangles.row(2));
  return mesh;
}

// Square [0, 1] x [0, 1] at height z, subdivided, facing up.
Mesh square(double z, int n = 8) {
  Mesh mesh;
  mesh.vertices.resize(3, (n + 1) * (n + 1));
  mesh.triangles.resize(3, 2 * n * n);
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) mesh.vertices.col(j * (n + 1) + i) = Point<3>(double(i) / n, double(j) / n, z);
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const int v = j * (n + 1) + i;
      mesh.triangles.col(2 * (j * n + i)) = Eigen::Vector3i(v, v + 1, v + n + 1);
      mesh.triangles.col(2 * (j * n + i) + 1) = Eigen::Vector3i(v + 1, v + n + 2, v + n + 1);
    }
  }
  return mesh;
}

TEST(Compare, ParallelSquaresAreTheirDistanceApart) {
  const MeshComparison result = compare(square(0.25), square(0), {.samples = 5000});
  const double expected = 0.25 / std::sqrt(2.0);
  for (const DistanceStatistics& side : {result.accuracy, result.completeness}) {
    EXPECT_NEAR(side.mean, expected, rounding);
    EXPECT_NEAR(side.rms, expected, rounding);
    EXPECT_NEAR(side.p99, expected, rounding);
    EXPECT_NEAR(side.max, expected, rounding);
  }
  EXPECT_NEAR(result.chamfer_mean, expected, rounding);
  EXPECT_NEAR(result.hausdorff99, expected, rounding);
  EXPECT_NEAR(result.normal_error_deg, 0, rounding);
  EXPECT_NEAR(result.diagonal, std::sqrt(2.0), rounding);
  EXPECT_FALSE(result.topology.watertight());
  EXPECT_TRUE(result.topology.manifold());
}

TEST(Compare, AMissingHalfShowsInCompletenessOnly) {
  Mesh half = square(0);
  half.triangles = half.triangles.leftCols(half.triangles.cols() / 2).eval();
  const MeshComparison result = compare(half, square(0));
  EXPECT_NEAR(result.accuracy.max, 0, rounding);
  // Distance from the missing half to the edge y = 1/2: uniform in [0, 1/2] on half of the samples.
  const double stratification = 1e-4;
  EXPECT_NEAR(result.completeness.mean, 0.125 / std::sqrt(2.0), stratification);
  EXPECT_NEAR(result.completeness.p99, 0.49 / std::sqrt(2.0), stratification);
  EXPECT_NEAR(result.completeness.rms, std::sqrt(1.0 / 24) / std::sqrt(2.0), stratification);
}

TEST(Compare, InvertedNormalsCount180Degrees) {
  const Mesh mesh = unit_sphere(12);
  EXPECT_NEAR(compare(inverted(mesh), mesh, {.samples = 2000}).normal_error_deg, 180, rounding_deg);
}

TEST(Compare, PointsAtAKnownDistanceFromTheMesh) {
  PointCloud cloud;
  cloud.points.resize(3, 101);
  cloud.normals.resize(3, 101);
  for (int i = 0; i <= 100; ++i) {
    cloud.points.col(i) = Point<3>(i / 100.0, 0.5, i / 100.0);
    cloud.normals.col(i) = Point<3>(1, 0, 1);
  }
  const PointComparison result = compare(square(0), cloud);
  EXPECT_NEAR(result.distance.mean, 0.5 / std::sqrt(2.0), rounding);
  EXPECT_NEAR(result.distance.p99, 0.99 / std::sqrt(2.0), rounding);
  EXPECT_NEAR(result.distance.max, 1 / std::sqrt(2.0), rounding);
  EXPECT_NEAR(result.distance.rms, std::sqrt(0.5 * 0.335), rounding);  // sum of squares 0..100 is 338350
  EXPECT_NEAR(result.normal_error_deg, 45, rounding);
  cloud.normals.resize(3, 0);
  EXPECT_TRUE(std::isnan(compare(square(0), cloud).normal_error_deg));
}

TEST(Compare, AMeshEqualsItself) {
  const Mesh mesh = unit_sphere(15);
  const MeshComparison result = compare(mesh, mesh, {.samples = 5000});
  EXPECT_LT(result.accuracy.max, rounding);
  EXPECT_LT(result.completeness.max, rounding);
  EXPECT_LT(result.normal_error_deg, rounding);
  EXPECT_TRUE(result.topology.watertight());
  EXPECT_TRUE(result.topology.manifold());
  EXPECT_EQ(result.topology.components, 1);
  EXPECT_EQ(result.topology.euler, 2);
}

TEST(Compare, ChamferAndHausdorffAreSymmetricUpToTheDiagonal) {
  const Mesh coarse = unit_sphere(8), fine = unit_sphere(30);
  const MeshComparison forth = compare(coarse, fine, {.samples = 5000});
  const MeshComparison back = compare(fine, coarse, {.samples = 5000});
  EXPECT_NEAR(forth.chamfer_mean * forth.diagonal, back.chamfer_mean * back.diagonal, rounding);
  EXPECT_NEAR(forth.hausdorff99 * forth.diagonal, back.hausdorff99 * back.diagonal, rounding);
  EXPECT_NEAR(forth.normal_error_deg, back.normal_error_deg, rounding_deg);
}

TEST(Compare, DistancesAreInvariantUnderScaling) {
  const Mesh mesh = unit_sphere(8), reference = unit_sphere(20);
  const MeshComparison expected = compare(mesh, reference, {.samples = 5000});
  for (const double scale : {1e-30, 1e30}) {
    const auto scaled = [&](const Mesh& m) { return transformed(m, scale, Eigen::Matrix3d::Identity(), {0, 0, 0}); };
    const MeshComparison result = compare(scaled(mesh), scaled(reference), {.samples = 5000});
    EXPECT_NEAR(result.chamfer_mean, expected.chamfer_mean, rounding);
    EXPECT_NEAR(result.hausdorff99, expected.hausdorff99, rounding);
    EXPECT_NEAR(result.normal_error_deg, expected.normal_error_deg, tied_normals);
  }
}

TEST(Compare, DistancesAreInvariantUnderMotionUpToTheDiagonalOfTheBox) {
  const Mesh mesh = unit_sphere(8), reference = unit_sphere(20);
  const MeshComparison expected = compare(mesh, reference, {.samples = 5000});
  const Eigen::Matrix3d rotation = Eigen::AngleAxisd(1.1, Point<3>(1, 2, 3).normalized()).toRotationMatrix();
  const auto moved = [&](const Mesh& m) { return transformed(m, 1, rotation, {30, -20, 10}); };
  const MeshComparison result = compare(moved(mesh), moved(reference), {.samples = 5000});
  EXPECT_NEAR(result.chamfer_mean * result.diagonal, expected.chamfer_mean * expected.diagonal, rounding);
  EXPECT_NEAR(result.hausdorff99 * result.diagonal, expected.hausdorff99 * expected.diagonal, rounding);
}

TEST(Compare, DoesNotDependOnTheNumberOfThreads) {
  const Mesh mesh = unit_sphere(8), reference = unit_sphere(20);
  set_thread_count(1);
  const MeshComparison serial = compare(mesh, reference, {.samples = 20000});
  set_thread_count(4);
  const MeshComparison parallel = compare(mesh, reference, {.samples = 20000});
  set_thread_count(0);
  EXPECT_EQ(serial.chamfer_mean, parallel.chamfer_mean);
  EXPECT_EQ(serial.hausdorff99, parallel.hausdorff99);
  EXPECT_EQ(serial.normal_error_deg, parallel.normal_error_deg);
}

TEST(Compare, ChamferOfInscribedSpheresFallsWithTheSquareOfTheEdgeLength) {
  const Mesh sphere = unit_sphere(200);
  double previous = 0;
  for (int rings = 4; rings <= 32; rings *= 2) {
    const double chamfer = compare(unit_sphere(rings), sphere, {.samples = 20000}).chamfer_mean;
    if (previous > 0) {
      EXPECT_GE(std::log2(previous / chamfer), 1.9) << rings << " rings";
    }
    previous = chamfer;
  }
}

TEST(Compare, StopsWhenTheProgressCallbackSaysSo) {
  const Mesh mesh = unit_sphere(8);
  EXPECT_THROW(compare(mesh, mesh, {.progress = [](std::string_view, double) { return false; }}), Cancelled);
}

TEST(Compare, RejectsWhatCannotBeCompared) {
  const Mesh mesh = unit_sphere(8);
  const auto message = [](auto&& action) { return invalid_input_message(action); };
  EXPECT_NE(message([&] { compare(Mesh{}, mesh); }).find("no surface"), std::string::npos);
  EXPECT_NE(message([&] { compare(mesh, Mesh{}); }).find("no surface"), std::string::npos);
  EXPECT_NE(message([&] { compare(mesh, mesh, {.samples = 0}); }).find("samples = 0"), std::string::npos);
  PointCloud cloud;
  EXPECT_NE(message([&] { compare(mesh, cloud); }).find("the cloud is empty"), std::string::npos);
  cloud.points = Points<3>::Ones(3, 4);
  EXPECT_NE(message([&] { compare(mesh, cloud); }).find("all points are the same"), std::string::npos);
  cloud.points(0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(message([&] { compare(mesh, cloud); }).find("must be finite"), std::string::npos);
}

}  // namespace
}  // namespace csrbf::compare_test
