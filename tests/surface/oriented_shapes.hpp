#pragma once

#include "csrbf/core/types.hpp"

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <random>
#include <vector>

namespace csrbf {

/// Samples of a surface with their exact outward normals; each stands for area / size of it.
struct Shape {
  Points<3> points{3, 0};
  Points<3> normals{3, 0};
  double area = 0;

  [[nodiscard]] Index size() const { return points.cols(); }
  [[nodiscard]] double spacing() const { return std::sqrt(area / static_cast<double>(size())); }
};

inline Shape join(const Shape& a, const Shape& b) {
  Shape both{Points<3>(3, a.size() + b.size()), Points<3>(3, a.size() + b.size()), a.area + b.area};
  both.points << a.points, b.points;
  both.normals << a.normals, b.normals;
  return both;
}

/// Evenly spread (Fibonacci) points.
inline Shape even_sphere(Index count, const Point<3>& center = Point<3>::Zero(), double radius = 1) {
  Shape shape{Points<3>(3, count), Points<3>(3, count), 4 * std::numbers::pi * radius * radius};
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
  for (Index i = 0; i < count; ++i) {
    const double z = 1 - (2.0 * static_cast<double>(i) + 1) / static_cast<double>(count), r = std::sqrt(1 - z * z);
    const double angle = golden * static_cast<double>(i);
    shape.normals.col(i) << r * std::cos(angle), r * std::sin(angle), z;
    shape.points.col(i) = center + radius * shape.normals.col(i);
  }
  return shape;
}

/// The components one after the other: compilers evaluate arguments in any order.
inline Point<3> gaussian(std::normal_distribution<double>& normal, std::mt19937_64& random) {
  Point<3> x;
  for (const int axis : {2, 1, 0}) x[axis] = normal(random);
  return x;
}

inline Shape random_sphere(Index count, unsigned seed, const Point<3>& center = Point<3>::Zero(), double radius = 1) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Shape shape{Points<3>(3, count), Points<3>(3, count), 4 * std::numbers::pi * radius * radius};
  for (Index i = 0; i < count; ++i) {
    shape.normals.col(i) = gaussian(normal, random).normalized();
    shape.points.col(i) = center + radius * shape.normals.col(i);
  }
  return shape;
}

constexpr double torus_major = 1, torus_minor = 0.35;

/// Uniformly distributed points of a torus around z; `noise` is a standard deviation.
inline Shape random_torus(Index count, unsigned seed, double noise = 0) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform;
  std::normal_distribution<double> normal;
  Shape shape{Points<3>(3, count), Points<3>(3, count),
              4 * std::numbers::pi * std::numbers::pi * torus_major * torus_minor};
  for (Index i = 0; i < count;) {
    const double u = 2 * std::numbers::pi * uniform(random), v = 2 * std::numbers::pi * uniform(random);
    if (uniform(random) * (torus_major + torus_minor) > torus_major + torus_minor * std::cos(v)) continue;
    shape.normals.col(i) << std::cos(u) * std::cos(v), std::sin(u) * std::cos(v), std::sin(v);
    shape.points.col(i) = torus_minor * shape.normals.col(i) + torus_major * Point<3>(std::cos(u), std::sin(u), 0);
    if (noise > 0) shape.points.col(i) += noise * gaussian(normal, random);
    ++i;
  }
  return shape;
}

/// Random points of waves on the unit square; `noise` is a standard deviation.
inline Shape random_hills(Index count, double height, unsigned seed, double noise = 0) {
  constexpr double kx = 12, ky = 3;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform;
  std::normal_distribution<double> normal;
  Shape shape{Points<3>(3, count), Points<3>(3, count), 1};
  for (Index i = 0; i < count; ++i) {
    const double x = uniform(random), y = uniform(random), phase = kx * x + ky * y, slope = height * std::cos(phase);
    shape.points.col(i) << x, y, height * std::sin(phase);
    shape.normals.col(i) = Point<3>(-kx * slope, -ky * slope, 1).normalized();
    if (noise > 0) shape.points.col(i) += noise * gaussian(normal, random);
  }
  return shape;
}

/// Random points of a plain with houses on it, which have no floors.
inline Shape random_houses(Index count, unsigned seed) {
  constexpr int rows = 3;  // of houses
  constexpr double width = 0.12, height = 0.15;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform;
  Shape shape{Points<3>(3, count), Points<3>(3, count), 1 + rows * rows * 4 * width * height};
  for (Index i = 0; i < count; ++i) {
    const double where = uniform(random) * shape.area, x = uniform(random), y = uniform(random);
    if (where < 1) {  // the plain, or a roof
      const auto in_house = [](double t) {
        return std::abs(rows * t - std::floor(rows * t) - 0.5) < 0.5 * rows * width;
      };
      shape.points.col(i) << x, y, in_house(x) && in_house(y) ? height : 0;
      shape.normals.col(i) << 0, 0, 1;
    } else {  // a wall
      const auto wall = static_cast<int>((where - 1) / (shape.area - 1) * rows * rows * 4) % (rows * rows * 4);
      const int house = wall / 4, axis = wall % 2;
      const double side = wall % 4 < 2 ? -1 : 1;
      Point<3> p((house % rows + 0.5) / rows, (house / rows + 0.5) / rows, height * y);
      p[axis] += 0.5 * width * side;
      p[1 - axis] += width * (x - 0.5);
      shape.points.col(i) = p;
      shape.normals.col(i) = side * Point<3>::Unit(axis);
    }
  }
  return shape;
}

/// Random points of a block of houses around a yard in the unit square: ground, roof and walls, seen from above.
inline Shape random_block(Index count, unsigned seed) {
  constexpr double outer = 0.35, inner = 0.15, height = 0.25;  // half widths of block and yard
  constexpr double outer_walls = 8 * outer * height, inner_walls = 8 * inner * height;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-0.5, 0.5);
  Shape shape{Points<3>(3, count), Points<3>(3, count), 1 + outer_walls + inner_walls};
  for (Index i = 0; i < count; ++i) {
    const double where = (uniform(random) + 0.5) * shape.area, x = uniform(random), y = uniform(random);
    if (where < 1) {
      const double away = std::max(std::abs(x), std::abs(y));
      shape.points.col(i) << x, y, inner < away && away < outer ? height : 0;
      shape.normals.col(i) << 0, 0, 1;
      continue;
    }
    const double half = where < 1 + outer_walls ? outer : inner, side = x < 0 ? -1 : 1;
    const Index axis = std::abs(x) < 0.25 ? 0 : 1;
    Point<3> p(0, 0, height * (y + 0.5));
    p[axis] = side * half;
    p[1 - axis] = 2 * half * uniform(random);
    shape.points.col(i) = p;
    shape.normals.col(i) = (half == outer ? side : -side) * Point<3>::Unit(axis);
  }
  return shape;
}

/// Random points of a ball that stands on the ground, a square, and of what is seen of the ground.
inline Shape random_ball_on_ground(Index count, unsigned seed) {
  constexpr double radius = 0.4, center = 0.3, side = 2;  // height of the centre
  constexpr double seen = 2 * std::numbers::pi * radius * (radius + center);
  constexpr double ground = side * side - std::numbers::pi * (radius * radius - center * center);
  const auto on_ball = static_cast<Index>(static_cast<double>(count) * seen / (seen + ground));
  Shape shape{Points<3>(3, count), Points<3>(3, count), seen + ground};
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-0.5, 0.5);
  std::normal_distribution<double> normal;
  for (Index i = 0; i < count;) {
    Point<3> n = gaussian(normal, random).normalized(), p = radius * n + Point<3>(0, 0, center);
    if (i >= on_ball) {
      n = Point<3>(0, 0, 1);
      p << side * uniform(random), side * uniform(random), 0;
      if (p.norm() < std::sqrt(radius * radius - center * center)) continue;
    } else if (p[2] < 0) {
      continue;
    }
    shape.points.col(i) = p;
    shape.normals.col(i++) = n;
  }
  return shape;
}

/// Random points of a bowl: most of a hollow ball of radius 1 with a hole at the top, whose wall is `thickness`
/// spacings thick.
inline Shape random_bowl(Index count, double thickness, unsigned seed) {
  constexpr double rim = 0.4;  // height of the edge of the hole
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform;
  const double sheet = 2 * std::numbers::pi * (1 + rim),
               wall = thickness * std::sqrt(2 * sheet / static_cast<double>(count));
  const double edge = 2 * std::numbers::pi * std::sqrt(1 - rim * rim) * wall, inner = sheet * (1 - wall) * (1 - wall);
  Shape shape{Points<3>(3, count), Points<3>(3, count), sheet + inner + edge};
  for (Index i = 0; i < count; ++i) {
    const double where = uniform(random) * shape.area, angle = 2 * std::numbers::pi * uniform(random);
    const bool on_edge = where > sheet + inner, outside = where < sheet;
    const double z = on_edge ? rim : rim - (1 + rim) * uniform(random), r = std::sqrt(1 - z * z);
    const Point<3> ray(r * std::cos(angle), r * std::sin(angle), z);
    const double radius = on_edge ? 1 - wall * uniform(random) : outside ? 1 : 1 - wall;
    shape.points.col(i) = radius * ray;
    shape.normals.col(i) = on_edge   ? Point<3>(-z * std::cos(angle), -z * std::sin(angle), r)
                           : outside ? ray
                                     : Point<3>(-ray);
  }
  return shape;
}

/// Random points of a box around the origin, about one per spacing^2.
inline Shape random_box(const Point<3>& half, double spacing, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Point<3>> points, normals;
  Shape shape;
  for (Index axis = 0; axis < 3; ++axis) {
    const Index second = (axis + 1) % 3, third = (axis + 2) % 3;
    const double area = 4 * half[second] * half[third];
    shape.area += 2 * area;
    for (const double side : {-1.0, 1.0})
      for (Index k = 0; k < static_cast<Index>(area / (spacing * spacing)); ++k) {
        Point<3> p;
        p[axis] = side * half[axis];
        p[second] = uniform(random) * half[second];
        p[third] = uniform(random) * half[third];
        points.push_back(p);
        normals.push_back(side * Point<3>::Unit(axis));
      }
  }
  shape.points.resize(3, static_cast<Index>(points.size()));
  shape.normals = shape.points;
  for (std::size_t i = 0; i < points.size(); ++i) {
    shape.points.col(static_cast<Index>(i)) = points[i];
    shape.normals.col(static_cast<Index>(i)) = normals[i];
  }
  return shape;
}

inline Eigen::Matrix3d some_rotation() {
  return Eigen::Matrix3d((Eigen::Matrix3d() << 2, -1, 2, 2, 2, -1, -1, 2, 2).finished() / 3);
}

/// Normals with random signs.
inline Points<3> scrambled(const Points<3>& normals, unsigned seed) {
  std::mt19937_64 random(seed);
  Points<3> result = normals;
  for (Index i = 0; i < result.cols(); ++i)
    if ((random() & 1U) != 0) result.col(i) = -normals.col(i);
  return result;
}

/// Share of the normals on the right side.
inline double outward_share(const Points<3>& normals, const Points<3>& truth) {
  Index right = 0;
  for (Index i = 0; i < truth.cols(); ++i) right += normals.col(i).dot(truth.col(i)) > 0 ? 1 : 0;
  return static_cast<double>(right) / static_cast<double>(truth.cols());
}

/// Root mean square angle between the lines of two sets of unit normals, in degrees.
inline double angle_error(const Points<3>& normals, const Points<3>& truth) {
  double sum = 0;
  for (Index i = 0; i < truth.cols(); ++i) {
    const double sine = normals.col(i).cross(truth.col(i)).norm();
    sum += std::pow(std::asin(std::min(1.0, sine)), 2);
  }
  return std::sqrt(sum / static_cast<double>(truth.cols())) * 180 / std::numbers::pi;
}

/// Scans outside the project, next to it; tests that need them are skipped without.
inline std::filesystem::path scan(const std::string& name) {
  return std::filesystem::path(__FILE__).parent_path() / "../../../shared/data/surface" / name;
}

}  // namespace csrbf
