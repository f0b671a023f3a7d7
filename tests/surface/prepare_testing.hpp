#pragma once

#include "csrbf/surface/prepare/prepare.hpp"
#include "surface/surface_testing.hpp"

#include <set>

namespace csrbf {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double rounding = 1e-14;

inline bool warns(const PreparedCloud& prepared, const std::string& text) {
  const auto holds = [&](const std::string& warning) { return warning.find(text) != std::string::npos; };
  return std::any_of(prepared.warnings.begin(), prepared.warnings.end(), holds);
}

inline PointCloud without_normals(PointCloud cloud) {
  cloud.normals.resize(3, 0);
  return cloud;
}

/// Mean cosine between normals of a unit sphere and the outward direction.
inline double outward(const PreparedCloud& prepared, const PointCloud& input) {
  double sum = 0;
  for (Index i = 0; i < prepared.cloud.size(); ++i)
    sum += prepared.cloud.normals.col(i).dot(input.points.col(prepared.source[i]).normalized());
  return sum / static_cast<double>(prepared.cloud.size());
}

inline void expect_points_of_the_input(const PreparedCloud& prepared, const PointCloud& input) {
  ASSERT_EQ(static_cast<Index>(prepared.source.size()), prepared.cloud.size());
  EXPECT_EQ(prepared.cloud.normals.cols(), prepared.cloud.size());
  EXPECT_EQ(prepared.cloud.spacing.size(), prepared.cloud.size());
  Box<3> box;
  for (Index i = 0; i < prepared.cloud.size(); ++i) {
    const Point<3> p = input.points.col(prepared.source[i]);
    const Point<3> found = prepared.origin + prepared.scale * prepared.cloud.points.col(i);
    EXPECT_NEAR((found - p).norm() / prepared.scale, 0, rounding);
    EXPECT_NEAR(prepared.cloud.normals.col(i).norm(), 1, rounding);
    box.add(p);
  }
  EXPECT_EQ(prepared.bounds.lo, box.lo);
  EXPECT_EQ(prepared.bounds.hi, box.hi);
  const std::set<Index> distinct(prepared.source.begin(), prepared.source.end());
  EXPECT_EQ(distinct.size(), prepared.source.size());
}

}  // namespace csrbf
