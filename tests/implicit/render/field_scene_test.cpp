#include "csrbf/implicit/render/field_scene.hpp"

#include <gtest/gtest.h>

namespace csrbf::field_scene_test {
namespace {

constexpr double major = 1, minor = 0.4;

// Torus about z: minor^2 - (rho - major)^2 - z^2.
class Torus : public Field<3> {
 public:
  void evaluate_block(const PointsRef<3>& p, const JetBlock& out) const override {
    for (Index i = 0; i < p.cols(); ++i) {
      const double x = p(0, i), y = p(1, i), z = p(2, i);
      const double rho = std::hypot(x, y), a = rho - major;
      out.value[i] = minor * minor - a * a - z * z;
      if (out.gradient != nullptr)
        Eigen::Map<Point<3>>(out.gradient + 3 * i) = -2 * Point<3>(a * x / rho, a * y / rho, z);
      if (out.hessian == nullptr) continue;
      const double rho3 = rho * rho * rho;
      Eigen::Map<Eigen::Matrix<double, 6, 1>> H(out.hessian + 6 * i);
      H << 1 - major * y * y / rho3, major * x * y / rho3, 0, 1 - major * x * x / rho3, 0, 1;
      H *= -2;
    }
  }
  [[nodiscard]] Box<3> bounds() const override {
    Box<3> box;
    box.hi = Point<3>(major + minor, major + minor, minor);
    box.lo = -box.hi;
    return box;
  }
  [[nodiscard]] Points<3> seeds() const override { return Point<3>(major + minor, 0, 0); }
};

std::vector<Ray> rays_at_torus() {
  std::vector<Ray> rays;
  for (int i = -20; i <= 20; ++i)
    for (int j = -20; j <= 20; ++j)
      rays.push_back({Point<3>(i * 0.07, j * 0.07, 3), Point<3>(0.1, 0.05, -1).normalized()});
  return rays;
}

// The positions come from rays that meet a coarse polygonization; two Newton steps square the error twice.
constexpr double position_tolerance = 1e-7;

TEST(FieldScene, PutsHitsOnTheZeroSetWithTheNormalOfTheField) {
  const Torus torus;
  const FieldScene scene(torus, {.field_resolution = 40});
  const std::vector<Ray> rays = rays_at_torus();
  std::vector<SurfaceHit> hits(rays.size());
  scene.trace(rays, hits);
  int count = 0;
  for (const SurfaceHit& hit : hits) {
    if (!hit.exists()) continue;
    ++count;
    EXPECT_NEAR(torus(hit.position), 0, position_tolerance);
    const double rho = hit.position.head<2>().norm();
    const Point<3> center = major / rho * Point<3>(hit.position[0], hit.position[1], 0);
    EXPECT_TRUE(hit.normal.isApprox((hit.position - center).normalized(), position_tolerance));
    EXPECT_FALSE(hit.inside);
  }
  EXPECT_GT(count, 300);
}

TEST(FieldScene, KnowsTheCurvaturesOfATorus) {
  const Torus torus;
  const FieldScene mean(torus, {.color = RenderColor::mean_curvature, .field_resolution = 40});
  const FieldScene gaussian(torus, {.color = RenderColor::gaussian_curvature, .field_resolution = 40});
  const std::vector<Ray> rays = rays_at_torus();
  std::vector<SurfaceHit> mean_hits(rays.size()), gaussian_hits(rays.size());
  mean.trace(rays, mean_hits);
  gaussian.trace(rays, gaussian_hits);
  constexpr double curvature_tolerance = 1e-5;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!mean_hits[i].exists()) continue;
    const double rho = mean_hits[i].position.head<2>().norm();
    const double around_tube = 1 / minor, around_axis = (rho - major) / (minor * rho);
    EXPECT_NEAR(mean_hits[i].curvature, 0.5 * (around_tube + around_axis), curvature_tolerance);
    EXPECT_NEAR(gaussian_hits[i].curvature, around_tube * around_axis, curvature_tolerance);
  }
}

}  // namespace
}  // namespace csrbf::field_scene_test
