#pragma once

#include "csrbf/implicit/polygonize.hpp"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <functional>
#include <numbers>
#include <random>

// Fields and measures shared by the tests of polygonize.
namespace csrbf {

using std::numbers::pi;
inline constexpr double edge_margin = 1e-3;  // documented distance of vertices from lattice corners, in cells

// A field given by a function that returns the value and fills the gradient.
class Implicit : public Field<3> {
 public:
  using Function = std::function<double(const Point<3>& p, Point<3>& gradient)>;

  Implicit(Function function, const Box<3>& bounds, const Points<3>& seeds = Points<3>(3, 0))
      : function_(std::move(function)), bounds_(bounds), seeds_(seeds) {}

  void evaluate_block(const PointsRef<3>& x, const JetBlock& out) const override {
    for (Index i = 0; i < x.cols(); ++i) {
      Point<3> gradient;
      out.value[i] = function_(x.col(i), gradient);
      if (out.gradient != nullptr) Eigen::Map<Point<3>>(out.gradient + 3 * i) = gradient;
    }
  }
  [[nodiscard]] Box<3> bounds() const override { return bounds_; }
  [[nodiscard]] Points<3> seeds() const override { return seeds_; }

 private:
  Function function_;
  Box<3> bounds_;
  Points<3> seeds_;
};

inline Box<3> cube(double half) {
  return {Point<3>::Constant(-half), Point<3>::Constant(half)};
}

inline Points<3> columns(const std::vector<Point<3>>& points) {
  Points<3> result(3, static_cast<Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) result.col(static_cast<Index>(i)) = points[i];
  return result;
}

// (r^2 - |p - c|^2) / 2r: not a distance, so that edges hold no linear functions.
inline double ball(const Point<3>& p, const Point<3>& center, double radius, Point<3>& gradient) {
  gradient = -(p - center) / radius;
  return (radius * radius - (p - center).squaredNorm()) / (2 * radius);
}

inline const Point<3> off_center(0.0137, -0.0071, 0.0213);  // keeps symmetric shapes off the lattice

inline Implicit sphere(double radius = 1, const Point<3>& center = off_center) {
  return {[=](const Point<3>& p, Point<3>& g) { return ball(p, center, radius, g); },
          {center.array() - radius, center.array() + radius},
          columns({center + Point<3>(radius, 0, 0)})};
}

inline double torus_value(const Point<3>& p, double major, double minor, Point<3>& gradient) {
  const double q = std::hypot(p[0], p[1]);
  const double u = q - major;
  gradient = Point<3>(-2 * u * p[0] / q, -2 * u * p[1] / q, -2 * p[2]);
  return minor * minor - u * u - p[2] * p[2];
}

inline Implicit torus(double major, double minor) {
  return {[=](const Point<3>& p, Point<3>& g) { return torus_value(p - off_center, major, minor, g); },
          {off_center - Point<3>(major + minor, major + minor, minor),
           off_center + Point<3>(major + minor, major + minor, minor)},
          columns({off_center + Point<3>(major + minor, 0, 0)})};
}

// Lemniscate (x (x - 1)^2 (x - 2) + y^2)^2 + z^2 = 1/100: genus 2.
inline Implicit double_torus() {
  return {[](const Point<3>& p, Point<3>& g) {
            const double x = p[0];
            const double a = x * (x - 1) * (x - 1) * (x - 2) + p[1] * p[1];
            const double da = (x - 1) * (x - 1) * (x - 2) + 2 * x * (x - 1) * (x - 2) + x * (x - 1) * (x - 1);
            g = Point<3>(-2 * a * da, -4 * a * p[1], -2 * p[2]);
            return 0.01 - a * a - p[2] * p[2];
          },
          {{-0.1, -0.7, -0.15}, {2.1, 0.7, 0.15}}};
}

// Three unit spheres, each touching the others: level set of a product, whose gradient vanishes where they touch.
inline Implicit touching_spheres() {
  const std::array<Point<3>, 3> centers{Point<3>(-1, 0, 0), Point<3>(1, 0, 0), Point<3>(0, std::sqrt(3.0), 0)};
  return {[centers](const Point<3>& p, Point<3>& g) {
            std::array<double, 3> f;
            std::array<Point<3>, 3> df;
            for (int i = 0; i < 3; ++i) f[i] = -ball(p, centers[i], 1, df[i]);
            g = df[0] * f[1] * f[2] + f[0] * df[1] * f[2] + f[0] * f[1] * df[2];
            return -f[0] * f[1] * f[2];
          },
          {{-2, -1, -1}, {2, 1 + std::sqrt(3.0), 1}}};
}

// Between the spheres of radius 1 and 1 - thickness.
inline Implicit thin_shell(double thickness) {
  return {[=](const Point<3>& p, Point<3>& g) {
            const double r = p.norm();
            const bool outer = 1 - r < r - (1 - thickness);
            g = (outer ? -1 : 1) * p / r;
            return outer ? 1 - r : r - (1 - thickness);
          },
          cube(1), columns({{1, 0, 0}, {0, 0, -1 + thickness}})};
}

inline Implicit gyroid() {
  return {[](const Point<3>& p, Point<3>& g) {
            const Eigen::Array3d s = p.array().sin();
            const Eigen::Array3d c = p.array().cos();
            g = Point<3>(c[0] * c[1] - s[2] * s[0], c[1] * c[2] - s[0] * s[1], c[2] * c[0] - s[1] * s[2]);
            return s[0] * c[1] + s[1] * c[2] + s[2] * c[0];
          },
          {Point<3>::Zero(), Point<3>::Constant(2 * pi)}};
}

// Distance to the nearest of the planes that bound a turned box with these half sides around off_center: sharp edges.
inline Implicit turned_box(const Point<3>& half) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Point<3>(1, 2, 3).normalized()).toRotationMatrix();
  return {[=](const Point<3>& p, Point<3>& g) {
            const Point<3> q = turn.transpose() * (p - off_center);
            Index axis = 0;
            const double f = (half - q.cwiseAbs()).minCoeff(&axis);
            g = -std::copysign(1, q[axis]) * turn.col(axis);
            return f;
          },
          cube(half.norm()), columns({off_center + half[0] * turn.col(0)})};
}

// Trilinear interpolation of random values on an n^3 lattice with unit spacing.
inline Implicit noise(int n, std::uint64_t seed, bool small_integers = false) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::uniform_int_distribution<int> integer(-2, 2);
  std::vector<double> node(static_cast<std::size_t>(n) * n * n);
  for (double& v : node) v = small_integers ? integer(random) : uniform(random);
  const auto value = [n, node](const Point<3>& p, Point<3>& g) {
    const Eigen::Array3i cell = p.array().floor().cast<int>().max(0).min(n - 2);
    const Point<3> t = p - cell.matrix().cast<double>();
    double f = 0;
    g.setZero();
    for (int c = 0; c < 8; ++c) {
      const Eigen::Array3i d(c & 1, c >> 1 & 1, c >> 2);
      const Eigen::Array3i at = cell + d;
      const double v = node[(at[2] * n + at[1]) * n + at[0]];
      const Point<3> w = (d == 1).select(t.array(), 1 - t.array());
      const Point<3> sign = (d == 1).select(Eigen::Array3d::Ones(), -1.0);
      f += v * w.prod();
      g += v * Point<3>(sign[0] * w[1] * w[2], w[0] * sign[1] * w[2], w[0] * w[1] * sign[2]);
    }
    return f;
  };
  return {value, {Point<3>::Zero(), Point<3>::Constant(n - 1)}};
}

// Cells that coincide with those of the noise.
inline PolygonizeOptions lattice_of_noise(int n) {
  return {.resolution = n - 1, .bounds = {Point<3>::Zero(), Point<3>::Constant(n - 1)}};
}

inline double volume(const Mesh& mesh) {
  double sum = 0;
  for (Index t = 0; t < mesh.triangles.cols(); ++t) {
    const Eigen::Vector3i v = mesh.triangles.col(t);
    const Point<3> a = mesh.vertices.col(v[0]);
    sum += a.dot(Point<3>(mesh.vertices.col(v[1])).cross(Point<3>(mesh.vertices.col(v[2])))) / 6;
  }
  return sum;
}

inline Eigen::VectorXd areas(const Mesh& mesh) {
  Eigen::VectorXd result(mesh.triangles.cols());
  for (Index t = 0; t < mesh.triangles.cols(); ++t) {
    const Eigen::Vector3i v = mesh.triangles.col(t);
    const Point<3> a = mesh.vertices.col(v[0]);
    result[t] = 0.5 * (mesh.vertices.col(v[1]) - a).cross(mesh.vertices.col(v[2]) - a).norm();
  }
  return result;
}

inline void expect_closed_manifold(const Mesh& mesh) {
  const Topology t = topology(mesh);
  EXPECT_TRUE(t.watertight());
  EXPECT_TRUE(t.manifold());
  EXPECT_EQ(t.vertices, mesh.vertices.cols());
}

inline double largest_distance_to_sphere(const Mesh& mesh, double radius, const Point<3>& center) {
  return ((mesh.vertices.colwise() - center).colwise().norm().array() - radius).abs().maxCoeff();
}

inline bool identical(const Mesh& a, const Mesh& b) {
  return a.vertices == b.vertices && a.triangles == b.triangles && a.normals == b.normals;
}

}  // namespace csrbf
