#include "csrbf/approx/faults/fault_lines.hpp"

#include "csrbf/core/error.hpp"

#include <algorithm>
#include <cmath>

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
// Ends as near to another line touch it: coordinates in files are rounded. Of the extent of all lines.
constexpr double touching = 1e-5;

// Without vertices at, or within a distance from, the one before; the last one stays.
Eigen::Matrix2Xd without_repetitions(const Eigen::Matrix2Xd& line, double distance) {
  Eigen::Matrix2Xd kept(2, line.cols());
  Index count = 1;
  kept.col(0) = line.col(0);
  for (Index i = 1; i < line.cols(); ++i)
    if ((line.col(i) - kept.col(count - 1)).norm() > distance) kept.col(count++) = line.col(i);
  if (count == 1) ++count;
  kept.col(count - 1) = line.col(line.cols() - 1);
  return kept.leftCols(count);
}

}  // namespace

FaultLines::FaultLines(std::vector<Eigen::Matrix2Xd> lines) : lines_(std::move(lines)) {
  Box<2> box;
  for (const Eigen::Matrix2Xd& line : lines_) {
    require(line.cols() >= 2 && line.allFinite(), "fit", "faults", line.cols(),
            "every line needs two vertices at least, with finite coordinates");
    box.add(bounding_box<2>(line));
  }
  const double reach = touching * box.diagonal();
  std::vector<Eigen::Matrix2Xd> cleaned;
  Index segments = 0;
  for (const Eigen::Matrix2Xd& line : lines_) {
    cleaned.push_back(without_repetitions(line, reach));
    segments += cleaned.back().cols() - 1;
  }
  from_.resize(2, segments);
  to_.resize(2, segments);
  std::vector<Index> first, last;  // segments of each line
  Index next = 0;
  for (const Eigen::Matrix2Xd& line : cleaned) {
    const Index n = line.cols() - 1;
    from_.middleCols(next, n) = line.leftCols(n);
    to_.middleCols(next, n) = line.rightCols(n);
    first.push_back(next);
    next += n;
    last.push_back(next - 1);
  }
  std::vector<Point<2>> ends;
  std::vector<std::pair<Index, Point<2>>> longer_from, longer_to;
  for (std::size_t k = 0; k < cleaned.size(); ++k) {
    const auto meet = [&](Index segment, const Point<2>& end, const Point<2>& before, auto& longer) {
      if (goes_on(segment, end, before, reach))
        longer.emplace_back(segment, end + reach * (end - before).normalized());
      else
        ends.push_back(end);
    };
    meet(first[k], from_.col(first[k]), to_.col(first[k]), longer_from);
    meet(last[k], to_.col(last[k]), from_.col(last[k]), longer_to);
  }
  for (const auto& [segment, end] : longer_from) from_.col(segment) = end;
  for (const auto& [segment, end] : longer_to) to_.col(segment) = end;
  ends_.resize(2, std::ssize(ends));
  for (Index e = 0; e < ends_.cols(); ++e) ends_.col(e) = ends[static_cast<std::size_t>(e)];
}

// Whether another segment is at the end of one and goes on from there, not back along it as a copy does.
bool FaultLines::goes_on(Index segment, const Point<2>& end, const Point<2>& before, double reach) const {
  const Point<2> back = (before - end).normalized();
  for (Index s = 0; s < from_.cols(); ++s) {
    if (s == segment || !(distance_to_segment(end, from_.col(s), to_.col(s)) <= reach)) continue;
    for (const auto* ends : {&from_, &to_}) {
      const Point<2> way = ends->col(s) - end;
      const double along = way.dot(back);
      const bool is_back = along > 0 && std::abs(cross(way, back)) <= std::max(2 * reach, 1e-3 * along);
      if (way.norm() > reach && !is_back) return true;
    }
  }
  return false;
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
