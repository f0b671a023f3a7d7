#pragma once

#include "csrbf/core/types.hpp"

#include <span>

namespace csrbf {

/// Whether nearly all of the points, the middles of faces between voxels, lie on a few long straight lines (or planes,
/// where they differ in z), of at least that many points each on average. A stretch of a circle is none.
bool are_straight(std::span<const Point<3>> points, double least);

/// Whether nearly all of the points lie on two such lines in the plane and on circles around where these meet, as
/// around a sector that ultrasound scans.
bool is_sector(std::span<const Point<3>> points, double least);

/// Whether nearly all of the points lie on one circle in the plane across `axis`.
struct FittedCircle {
  Point<3> center;  ///< 0 along the axis
  double radius;
  bool fits;
};
FittedCircle fit_circle(std::span<const Point<3>> points, int axis);

}  // namespace csrbf
