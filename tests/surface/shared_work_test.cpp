#include "csrbf/core/shared_work.hpp"

#include "core/shared_work_testing.hpp"
#include "csrbf/implicit/polygonize.hpp"
#include "csrbf/surface/reconstruct.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

namespace csrbf {
namespace {

// A torus with noise, by its normals or without.
PointCloud torus(Index n, bool with_normals) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> angle(0, 2 * std::numbers::pi);
  std::normal_distribution<double> noise(0, 0.004);
  PointCloud cloud;
  cloud.points.resize(3, n);
  if (with_normals) cloud.normals.resize(3, n);
  for (Index i = 0; i < n; ++i) {
    const double u = angle(random), v = angle(random);
    const Point<3> normal(std::cos(v) * std::cos(u), std::cos(v) * std::sin(u), std::sin(v));
    cloud.points.col(i) = Point<3>(std::cos(u), std::sin(u), 0) + (0.4 + noise(random)) * normal;
    if (with_normals) cloud.normals.col(i) = normal;
  }
  return cloud;
}

// What reconstruct and polygonize share, when their result is the same for every one of some processes.
std::map<std::string, Index> shared_by(const PointCloud& cloud, const ReconstructOptions& options,
                                       const PolygonizeOptions& mesh_options = {}) {
  return compare_with_ranks(
      2,
      [&] {
        const Reconstruction surface = reconstruct(cloud, options);
        return std::pair{polygonize(*surface.field, mesh_options), surface.report.rms_distance};
      },
      [](const auto& a, const auto& b) {
        EXPECT_TRUE(a.first.vertices == b.first.vertices);
        EXPECT_TRUE(a.first.normals == b.first.normals);
        EXPECT_TRUE(a.first.triangles == b.first.triangles);
        EXPECT_EQ(a.second, b.second);
      });
}

TEST(SharedWork, ASurfaceWithNormalsIsTheSameForEveryProcess) {
  const auto items = shared_by(torus(20000, true), {});
  EXPECT_GT(items.at("fit"), 100);
  EXPECT_GT(items.at("choose options"), 100);
  EXPECT_GT(items.at("evaluate"), 20000);
  EXPECT_GT(items.at("partition"), 256);
  EXPECT_GT(items.at("polygonize"), 100);
}

TEST(SharedWork, ASurfaceWithEstimatedNormalsIsTheSameForEveryProcess) {
  const auto items = shared_by(torus(6000, false), {}, {.method = PolygonizeMethod::dual_contouring});
  EXPECT_GE(items.at("estimate normals"), 6000);
  EXPECT_GE(items.at("prepare"), 6000);
}

TEST(SharedWork, ASurfaceWithinAToleranceIsTheSameForEveryProcess) {
  shared_by(torus(3000, true), {.tolerance = 3e-3});
}

}  // namespace
}  // namespace csrbf
