#include "csrbf/implicit/mesh/sample_surface.hpp"

#include "csrbf/core/parallel.hpp"
#include "implicit/mesh_testing.hpp"

#include <gtest/gtest.h>

namespace csrbf::sample_surface_test {
namespace {

constexpr double rounding = 1e-13;

TEST(SampleSurface, PutsSamplesOnTheTriangleWithItsNormal) {
  const SurfaceSamples samples = sample_surface(right_triangle(), 1000);
  for (Index i = 0; i < 1000; ++i) {
    const Point<3> p = samples.points.col(i);
    EXPECT_GE(p.head<2>().minCoeff(), 0);
    EXPECT_LE(p[0] + p[1], 2 + rounding);
    EXPECT_EQ(p[2], 0);
    EXPECT_NEAR(samples.normals(2, i), 1, rounding);
    EXPECT_EQ(samples.triangle[i], 0);
  }
}

TEST(SampleSurface, DrawsEachTriangleInProportionToItsAreaUpToOneSample) {
  Mesh mesh;
  mesh.vertices.resize(3, 5);
  mesh.vertices << 0, 1, 0, 3, 5,  //
      0, 0, 1, 0, 0,               //
      0, 0, 0, 0, 0;
  mesh.triangles.resize(3, 4);
  mesh.triangles << 0, 1, 0, 1,  // areas 1/2, 1, 0 and 2
      1, 3, 3, 4,                //
      2, 2, 1, 2;
  const Index n = 700;
  std::array<double, 4> count{};
  for (const std::int32_t t : sample_surface(mesh, n).triangle) ++count[t];
  EXPECT_NEAR(count[0], 100, 1);
  EXPECT_NEAR(count[1], 200, 1);
  EXPECT_EQ(count[2], 0);
  EXPECT_NEAR(count[3], 400, 1);
}

TEST(SampleSurface, HasTheMeanAndTheSecondMomentsOfAUniformSphere) {
  const Index n = 100000;
  const SurfaceSamples samples = sample_surface(unit_sphere(100), n);
  const double statistical = 5 / std::sqrt(static_cast<double>(n));  // five standard deviations
  const double inscribed = 1e-3;                                     // the mesh lies inside the sphere
  EXPECT_LT(samples.points.rowwise().mean().norm(), statistical);
  const Eigen::Matrix3d second = samples.points * samples.points.transpose() / static_cast<double>(n);
  EXPECT_LT((second - Eigen::Matrix3d::Identity() / 3).cwiseAbs().maxCoeff(), statistical + inscribed);
}

TEST(SampleSurface, DependsOnTheSeedButNotOnTheNumberOfThreads) {
  const Mesh mesh = unit_sphere(20);
  set_thread_count(1);
  const SurfaceSamples serial = sample_surface(mesh, 20000);
  set_thread_count(4);
  const SurfaceSamples parallel = sample_surface(mesh, 20000);
  set_thread_count(0);
  EXPECT_EQ(serial.points, parallel.points);
  EXPECT_NE(serial.points, sample_surface(mesh, 20000, 8).points);
}

TEST(SampleSurface, RejectsMeshesWithoutAreaAndCountsBelowOne) {
  Mesh flat = right_triangle();
  flat.vertices.row(1).setZero();
  EXPECT_NE(invalid_input_message([&] { sample_surface(flat, 10); }).find("area = 0"), std::string::npos);
  EXPECT_NE(invalid_input_message([&] { sample_surface(Mesh{}, 10); }).find("area = 0"), std::string::npos);
  EXPECT_NE(invalid_input_message([&] { sample_surface(right_triangle(), 0); }).find("n = 0"), std::string::npos);
}

}  // namespace
}  // namespace csrbf::sample_surface_test
