#include "csrbf/approx/faults/fault_lines.hpp"

#include "csrbf/core/error.hpp"

#include <algorithm>

namespace csrbf {
namespace {

double cross(const Point<2>& a, const Point<2>& b) {
  return a[0] * b[1] - a[1] * b[0];
}

double distance_to_segment(const Point<2>& p, const Point<2>& a, const Point<2>& b) {
  const Point<2> d = b - a;
  const double length2 = d.squaredNorm();
  const double t = length2 > 0 ? std::clamp((p - a).dot(d) / length2, 0.0, 1.0) : 0;
  return (p - a - t * d).norm();
}

// Ways end a little before a corner, so that it does not block them.
constexpr double before_corner = 1 - 1e-9;

}  // namespace

FaultLines::FaultLines(std::vector<Eigen::Matrix2Xd> lines) : lines_(std::move(lines)) {
  Index segments = 0;
  for (const Eigen::Matrix2Xd& line : lines_) {
    require(line.cols() >= 2 && line.allFinite(), "fit", "faults", line.cols(),
            "every line needs two vertices at least, with finite coordinates");
    segments += line.cols() - 1;
  }
  from_.resize(2, segments);
  to_.resize(2, segments);
  ends_.resize(2, 2 * std::ssize(lines_));
  Index next = 0, ends = 0;
  for (const Eigen::Matrix2Xd& line : lines_) {
    const Index n = line.cols() - 1;
    from_.middleCols(next, n) = line.leftCols(n);
    to_.middleCols(next, n) = line.rightCols(n);
    next += n;
    if (line.col(0) == line.col(n)) continue;  // closed
    ends_.col(ends++) = line.col(0);
    ends_.col(ends++) = line.col(n);
  }
  ends_.conservativeResize(2, ends);
}

FaultLines::Nearby FaultLines::within(const Point<2>& p, double distance) const {
  Nearby nearby;
  for (Index s = 0; s < from_.cols(); ++s)
    if (distance_to_segment(p, from_.col(s), to_.col(s)) <= distance) nearby.segments.push_back(s);
  for (Index e = 0; e < ends_.cols(); ++e)
    if ((ends_.col(e) - p).norm() <= distance) nearby.ends.push_back(e);
  return nearby;
}

bool FaultLines::crosses(const Point<2>& p, const Point<2>& q, const std::vector<Index>& segments) const {
  const Point<2> d = q - p;
  for (const Index s : segments) {
    const Point<2> a = from_.col(s), e = to_.col(s) - a;
    const double denominator = cross(d, e);
    if (denominator == 0) continue;  // parallel: seen along the fault
    const double t = cross(a - p, e) / denominator, u = cross(a - p, d) / denominator;
    if (t > 0 && t < 1 && u >= 0 && u <= 1) return true;
  }
  return false;
}

Sight FaultLines::sight(const Point<2>& p, const Point<2>& q, const Nearby& nearby) const {
  if (!crosses(p, q, nearby.segments)) return {true, 0, p};
  Sight best;
  double shortest = std::numeric_limits<double>::infinity();
  for (const Index e : nearby.ends) {
    const Point<2> corner = ends_.col(e);
    const double there = (corner - p).norm(), length = there + (q - corner).norm();
    if (!(length < shortest) || crosses(p, p + before_corner * (corner - p), nearby.segments) ||
        crosses(q, q + before_corner * (corner - q), nearby.segments))
      continue;
    shortest = length;
    best = {true, there, corner};
  }
  return best;
}

}  // namespace csrbf
