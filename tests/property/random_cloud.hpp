#pragma once

#include "csrbf/core/mesh.hpp"

#include "property/property_testing.hpp"

#include <limits>
#include <numbers>

namespace csrbf {

/// Moves a point of the unit cube, the i-th of n, onto some shape, with its outward normal if there is one.
using Shape = void (*)(Index i, Index n, Point<3>& x, Point<3>& normal);

inline void onto_sphere(Index /*i*/, Index /*n*/, Point<3>& x, Point<3>& normal) {
  x = 0.5 * normal;
}

inline void onto_torus(Index /*i*/, Index /*n*/, Point<3>& x, Point<3>& normal) {
  const double phi = 2 * std::numbers::pi * x[0], theta = 2 * std::numbers::pi * x[1];
  const Point<3> out(std::cos(phi), std::sin(phi), 0);
  normal = std::cos(theta) * out + std::sin(theta) * Point<3>::UnitZ();
  x = 0.7 * out + 0.2 * normal;
}

inline void onto_plane(Index /*i*/, Index /*n*/, Point<3>& x, Point<3>& normal) {
  x[2] = 0;
  normal = Point<3>::UnitZ();
}

inline void onto_line(Index /*i*/, Index /*n*/, Point<3>& x, Point<3>& /*normal*/) {
  x = (x[0] - 0.5) * Point<3>(0.3, -0.5, 0.8);
}

/// Distances tie exactly.
inline void onto_square_grid(Index i, Index n, Point<3>& x, Point<3>& normal) {
  const auto side = static_cast<Index>(std::ceil(std::sqrt(static_cast<double>(n))));
  x << static_cast<double>(i % side), static_cast<double>(i / side), 0;
  x /= static_cast<double>(side);
  normal = Point<3>::UnitZ();
}

inline void onto_cubic_grid(Index i, Index n, Point<3>& x, Point<3>& /*normal*/) {
  const auto side = static_cast<Index>(std::ceil(std::cbrt(static_cast<double>(n))));
  x << static_cast<double>(i % side), static_cast<double>(i / side % side), static_cast<double>(i / side / side);
  x /= static_cast<double>(side);
}

inline void onto_two_sheets_that_touch(Index i, Index /*n*/, Point<3>& x, Point<3>& normal) {
  const double side = i % 2 == 0 ? 1 : -1;
  x[2] = side * 1e-3 * (x[0] + x[1]);
  normal = side * Point<3>::UnitZ();
}

inline void onto_box(Index i, Index /*n*/, Point<3>& x, Point<3>& normal) {
  const Index axis = i % 3;
  x[axis] = i % 2 == 0 ? 0 : 1;
  normal = (2 * x[axis] - 1) * Point<3>::Unit(axis);
}

inline void anywhere(Index /*i*/, Index /*n*/, Point<3>& /*x*/, Point<3>& /*normal*/) {}

/// n points on one shape.
inline PointCloud random_part(Random& random, Index n) {
  const auto shape = random.any_of<Shape>({onto_sphere, onto_torus, onto_plane, onto_line, onto_square_grid,
                                           onto_cubic_grid, onto_two_sheets_that_touch, onto_box, anywhere});
  PointCloud part{Points<3>(3, n), Points<3>(3, n), {}};
  for (Index i = 0; i < n; ++i) {
    Point<3> x = random.in_unit_cube<3>(1), normal = random.direction<3>();
    shape(i, n, x, normal);
    part.points.col(i) = x;
    part.normals.col(i) = normal;
  }
  return part;
}

inline void append(PointCloud& cloud, const PointCloud& part) {
  const Index n = cloud.size();
  cloud.points.conservativeResize(3, n + part.size());
  cloud.normals.conservativeResize(3, n + part.size());
  cloud.points.rightCols(part.size()) = part.points;
  cloud.normals.rightCols(part.size()) = part.normals;
}

/// Parts of very different size and density, some at the same place, some far away.
inline PointCloud random_parts(Random& random, Index most) {
  PointCloud cloud{Points<3>(3, 0), Points<3>(3, 0), {}};
  for (int parts = random.one_in(2) ? 1 : random.whole(2, 4); parts > 0; --parts) {
    PointCloud part = random_part(random, static_cast<Index>(random.magnitude(0.6, std::log10(most))));
    if (parts > 1) part.points *= random.magnitude(-6, 0.5);
    if (random.one_in(2)) part.points.colwise() += 2 * random.direction<3>();
    append(cloud, part);
  }
  return cloud;
}

inline void add_noise_and_duplicates(Random& random, PointCloud& cloud) {
  const Index n = cloud.size();
  if (random.one_in(3)) {
    const double sigma = random.magnitude(-12, -0.5);
    cloud.points += Points<3>::NullaryExpr(3, n, [&] { return sigma * random.normal(); });
  }
  if (random.one_in(3))  // every point a few times, with normals of its own
    for (Index i = 0; i < n; ++i) cloud.points.col(i) = cloud.points.col(i - i % random.whole(1, 4));
  if (random.one_in(5)) append(cloud, {1e6 * random.direction<3>(), random.direction<3>(), {}});  // a far outlier
  if (random.one_in(8)) cloud.points.row(random.whole(0, 2)) *= random.one_in(2) ? 0 : random.magnitude(-9, -1);
}

inline void spoil_normals(Random& random, PointCloud& cloud) {
  const int kind = random.whole(0, 8);
  const double share = random.one_in(2) ? 0.1 : 0.5;
  for (Index i = 0; i < cloud.size(); ++i) {
    if (random.unit() > share) continue;
    auto normal = cloud.normals.col(i);
    if (kind == 0) normal *= -1;
    if (kind == 1) normal.setZero();
    if (kind == 2) normal = random.direction<3>();
    if (kind == 3) normal *= random.magnitude(-300, 300);
    if (kind == 4) normal[random.whole(0, 2)] = std::numeric_limits<double>::quiet_NaN();
  }
  if (kind == 5) cloud.normals.resize(3, 0);
  if (kind == 6) cloud.normals *= -1;
}

/// A cloud of 4 to a few thousand points that nobody should have measured.
inline PointCloud random_cloud(Random& random, Index most) {
  PointCloud cloud = random_parts(random, most);
  add_noise_and_duplicates(random, cloud);
  if (random.one_in(2)) cloud.points *= random.magnitude(-12, 12);
  if (random.one_in(4)) cloud.points.colwise() += random.magnitude(-3, 9) * random.direction<3>();
  spoil_normals(random, cloud);
  if (random.one_in(6)) {
    const std::vector<double> numbers{std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                                      1e300, -1e300, std::numeric_limits<double>::denorm_min()};
    for (int times = random.whole(1, 3); times > 0; --times)
      cloud.points(random.whole(0, 2), random.whole(0, static_cast<int>(cloud.size()) - 1)) = random.any_of(numbers);
  }
  return cloud;
}

}  // namespace csrbf
