#pragma once

#include "csrbf/core/types.hpp"

#include <Eigen/Geometry>

namespace csrbf {

/// The point of a primitive closest to a query point.
struct ClosestPoint {
  Point<3> point = Point<3>::Zero();
  double squared_distance = std::numeric_limits<double>::infinity();
};

/// Closest point of the segment ab to x; the ends may coincide.
inline ClosestPoint closest_on_segment(const Point<3>& x, const Point<3>& a, const Point<3>& b) {
  const Point<3> ab = b - a;
  const double length2 = ab.squaredNorm();
  const double t = length2 > 0 ? std::clamp((x - a).dot(ab) / length2, 0.0, 1.0) : 0.0;
  const Point<3> q = a + t * ab;
  return {q, (x - q).squaredNorm()};
}

/// Closest point of the triangle abc to x. Every candidate lies on the triangle, so the distance is correct for
/// needles, slivers and triangles that degenerate to a segment or a point too.
inline ClosestPoint closest_on_triangle(const Point<3>& x, const Point<3>& a, const Point<3>& b, const Point<3>& c) {
  const Point<3> ab = b - a, ac = c - a, ax = x - a;
  const double bb = ab.squaredNorm(), cc = ac.squaredNorm(), bc = ab.dot(ac);
  const double xb = ax.dot(ab), xc = ax.dot(ac);
  const double det = bb * cc - bc * bc;
  const double v = cc * xb - bc * xc;  // barycentric weights of b and c, times det
  const double w = bb * xc - bc * xb;

  // The error of the weights is rounding over the squared sine at a; if that is small every edge is a candidate too.
  constexpr double well_shaped = 1e-2;  // squared sine of 6 degrees; chosen by hand: loses two digits at most
  const bool flat = !(det > well_shaped * bb * cc);
  ClosestPoint best;
  if (v >= 0 && w >= 0 && v + w <= det && det > 0) {
    const Point<3> q = a + (v / det) * ab + (w / det) * ac;
    best = {q, (x - q).squaredNorm()};
    if (!flat) return best;
  }
  // Otherwise the closest point is on an edge that x lies beyond.
  const auto try_edge = [&](const Point<3>& from, const Point<3>& to) {
    const ClosestPoint edge = closest_on_segment(x, from, to);
    if (edge.squared_distance < best.squared_distance) best = edge;
  };
  if (flat || v <= 0) try_edge(a, c);
  if (flat || w <= 0) try_edge(a, b);
  if (flat || v + w >= det) try_edge(b, c);
  return best;
}

/// Normal of the triangle abc by the right-hand rule, its length twice the area.
inline Point<3> area_vector(const Point<3>& a, const Point<3>& b, const Point<3>& c) {
  return (b - a).cross(c - a);
}

/// Two unit vectors that complete the unit vector n to a right-handed orthonormal frame.
inline std::array<Point<3>, 2> tangents(const Point<3>& n) {
  Index smallest = 0;
  n.cwiseAbs().minCoeff(&smallest);
  const Point<3> t = n.cross(Point<3>::Unit(smallest)).normalized();
  return {t, n.cross(t)};
}

}  // namespace csrbf
