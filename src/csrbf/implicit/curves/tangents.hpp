#pragma once

#include "csrbf/core/types.hpp"

#include <Eigen/Geometry>

#include <array>

namespace csrbf {

/// Two unit vectors that complete the unit vector n to a right-handed orthonormal frame.
inline std::array<Point<3>, 2> tangents(const Point<3>& n) {
  Index smallest = 0;
  n.cwiseAbs().minCoeff(&smallest);
  const Point<3> t = n.cross(Point<3>::Unit(smallest)).normalized();
  return {t, n.cross(t)};
}

}  // namespace csrbf
