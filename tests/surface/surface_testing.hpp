#pragma once

#include "core/error_testing.hpp"
#include "csrbf/core/mesh.hpp"
#include "csrbf/surface/composite/composite.hpp"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

// Clouds and shapes shared by the tests of surfaces.
namespace csrbf {

using std::numbers::pi;

/// i-th point of an evenly spread sequence in the unit square (Roberts 2018): no two points are close.
inline Eigen::Vector2d quasi_random(Index i, unsigned seed) {
  constexpr double g = 1.32471795724474602596;  // the real root of g^3 = g + 1
  const auto k = static_cast<double>(i) + 0.5 + 0.618 * seed;
  const double u = k / g, v = k / (g * g);
  return {u - std::floor(u), v - std::floor(v)};
}

/// n samples spread evenly over a sphere, with outward normals.
inline PointCloud sphere_cloud(Index n, unsigned seed = 1, double radius = 1, const Point<3>& center = {0, 0, 0}) {
  PointCloud cloud{Points<3>(3, n), Points<3>(3, n), {}};
  for (Index i = 0; i < n; ++i) {
    const Eigen::Vector2d uv = quasi_random(i, seed);
    const double z = 2 * uv[0] - 1, phi = 2 * pi * uv[1], rho = std::sqrt(1 - z * z);
    cloud.normals.col(i) << rho * std::cos(phi), rho * std::sin(phi), z;
    cloud.points.col(i) = center + radius * cloud.normals.col(i);
  }
  return cloud;
}

/// Torus around the z axis.
struct Torus {
  double major = 1, minor = 0.35;

  [[nodiscard]] double area() const { return 4 * pi * pi * major * minor; }
  /// Signed distance to the surface, positive inside.
  [[nodiscard]] double depth(const Point<3>& p) const {
    return minor - std::hypot(std::hypot(p[0], p[1]) - major, p[2]);
  }
  /// n samples spread evenly over it, with outward normals.
  [[nodiscard]] PointCloud cloud(Index n, unsigned seed = 1) const {
    PointCloud result{Points<3>(3, n), Points<3>(3, n), {}};
    for (Index i = 0; i < n; ++i) {
      const Eigen::Vector2d uv = quasi_random(i, seed);
      // Area up to the angle theta around the tube: theta + (minor / major) sin(theta), inverted by Newton's method.
      const double target = 2 * pi * uv[0], q = minor / major;
      double theta = target;
      for (int k = 0; k < 20; ++k) theta -= (theta + q * std::sin(theta) - target) / (1 + q * std::cos(theta));
      const double phi = 2 * pi * uv[1];
      const Point<3> out(std::cos(phi), std::sin(phi), 0);
      result.normals.col(i) = std::cos(theta) * out + std::sin(theta) * Point<3>::UnitZ();
      result.points.col(i) = major * out + minor * result.normals.col(i);
    }
    return result;
  }
};

inline PointCloud joined(const PointCloud& a, const PointCloud& b) {
  PointCloud both{Points<3>(3, a.size() + b.size()), Points<3>(3, a.normals.cols() + b.normals.cols()), {}};
  both.points << a.points, b.points;
  both.normals << a.normals, b.normals;
  return both;
}

/// Every point moved by Gaussian noise of standard deviation sigma along every axis.
inline PointCloud with_noise(PointCloud cloud, double sigma, unsigned seed = 1) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0, sigma);
  cloud.points += Points<3>::NullaryExpr(3, cloud.size(), [&] { return noise(random); });
  return cloud;
}

inline Points<3> random_points(Index n, const Box<3>& box, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  Points<3> points(3, n);
  for (Index i = 0; i < n; ++i)
    for (int c = 0; c < 3; ++c) points(c, i) = box.lo[c] + uniform(random) * (box.hi[c] - box.lo[c]);
  return points;
}

/// x -> scale * R x + shift.
struct Similarity {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  double scale = 1;
  Point<3> shift = Point<3>::Zero();

  [[nodiscard]] Points<3> operator()(const PointsRef<3>& x) const { return ((scale * R) * x).colwise() + shift; }
  [[nodiscard]] PointCloud operator()(const PointCloud& cloud) const {
    return {(*this)(cloud.points), R * cloud.normals, cloud.properties};
  }
};

inline Similarity rotation(double angle) {
  return {Eigen::AngleAxisd(angle, Point<3>(1, 2, -0.5).normalized()).toRotationMatrix(), 1, {0, 0, 0}};
}

/// The cloud with the spacing of samples spread evenly over `area`.
inline OrientedPoints oriented(const PointCloud& cloud, double area) {
  const Index n = cloud.size();
  return {cloud.points, cloud.normals, Eigen::VectorXd::Constant(n, std::sqrt(area / static_cast<double>(n)))};
}

inline void expect_closed(const Mesh& mesh, Index components, Index euler) {
  const Topology t = topology(mesh);
  EXPECT_TRUE(t.watertight());
  EXPECT_TRUE(t.manifold());
  EXPECT_EQ(t.components, components);
  EXPECT_EQ(t.euler, euler);
}

}  // namespace csrbf
