#include "csrbf/surface/contours/contour_points.hpp"

#include "csrbf/core/parallel.hpp"

#include <Eigen/Geometry>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr double offset_share = 0.5;  // of the spacing: largest offset, and half length of the arc a normal comes from
constexpr int most_halvings = 5;      // of the offset until it is clear of other contours
constexpr double probe = 0.1;         // of the distance to the neighbours: where the two sides of a contour are sampled
constexpr double clearance = 0.7;  // least depth at twice the offset, over twice the offset (1 on a straight contour)
constexpr Index grain = 16;        // contour points per task

// The first point along the loop, in steps of `step` from `at`, that is at least `distance` away.
Point<3> walk(const Points<3>& points, const ContourLoop& loop, Index at, Index step, double distance) {
  const auto n = static_cast<Index>(loop.size());
  const Point<3> start = points.col(loop[at]);
  Point<3> p = start;
  for (Index k = 1; k <= n / 3 || k == 1; ++k) {
    p = points.col(loop[((at + k * step) % n + n) % n]);
    if ((p - start).norm() >= distance) break;
  }
  return p;
}

// Tangent at p, to first order, of the circle through a, p and b.
Point<3> tangent(const Point<3>& a, const Point<3>& p, const Point<3>& b) {
  const double before = (p - a).norm(), after = (b - p).norm();
  if (!(before > 0 && after > 0)) return b - a;
  return after / before * (p - a) + before / after * (b - p);
}

// The largest offset with enough clearance, inside or else outside.
double find_offset(const Slice& slice, const ContourPoint& p, double most) {
  for (const double sign : {1.0, -1.0}) {
    double offset = most;
    for (int k = 0; k < most_halvings; ++k, offset /= 2) {
      const double depth = sign * slice.depth(slice.to_plane(p.position - 2 * sign * offset * p.outward));
      if (depth >= 2 * clearance * offset) return sign * offset;
    }
  }
  return 0;
}

ContourPoint contour_point(const Points<3>& points, const ContourLoop& loop, Index at, const Slice& slice,
                           double spacing) {
  ContourPoint p{points.col(loop[at])};
  const Point<3> a = walk(points, loop, at, -1, offset_share * spacing),
                 b = walk(points, loop, at, 1, offset_share * spacing);
  const Point<3> side = slice.normal().cross(tangent(a, p.position, b)).normalized();
  if (!side.allFinite() || side.isZero()) return p;
  const double step = probe * std::min((a - p.position).norm(), (b - p.position).norm());
  const bool in_front = slice.depth(slice.to_plane(p.position + step * side)) > 0,
             behind = slice.depth(slice.to_plane(p.position - step * side)) > 0;
  if (in_front == behind) return p;
  p.outward = behind ? side : Point<3>(-side);
  p.offset = find_offset(slice, p, offset_share * spacing);
  return p;
}

}  // namespace

std::vector<ContourPoint> contour_points(const Points<3>& points, const std::vector<ContourLoop>& loops,
                                         const Slices& slices, const std::vector<Index>& places, double spacing) {
  std::vector<Index> ends;
  for (const ContourLoop& loop : loops) ends.push_back((ends.empty() ? 0 : ends.back()) + std::ssize(loop));
  std::vector<ContourPoint> result(places.size());
  parallel_for(std::ssize(places), grain, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      const Index l = std::upper_bound(ends.begin(), ends.end(), places[i]) - ends.begin();
      const Index at = places[i] - (l > 0 ? ends[l - 1] : 0);
      result[i] = contour_point(points, loops[l], at, slices.slices[slices.slice_of[l]], spacing);
    }
  });
  return result;
}

}  // namespace csrbf
