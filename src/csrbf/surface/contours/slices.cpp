#include "csrbf/surface/contours/slices.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/small_matrices.hpp"

#include <Eigen/Geometry>

#include <numeric>
#include <utility>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr double same_plane = 1e-4;      // of the diagonal: closer slices are merged
constexpr double flatness = 0.02;        // largest deviation from a plane, of the contour's own size
constexpr double least_width = 1e-6;     // of the contour's own size: less is a line
constexpr double deviation_factor = 3;   // deviations of a contour from its own plane: distance from the plane of
                                         // another one that it may lie in (rounding of coordinates tilts planes)
constexpr std::size_t min_corners = 16;  // shorter contours are not examined for zigzag
constexpr double straight = 0.02;        // radians: corners that turn less are ignored
constexpr double jagged_angle = 0.2;     // radians: least mean turn of jagged contours; pixels turn by pi/2 or pi/4
constexpr double jagged_share = 0.5;     // least share of their corners that turn to the other side than the one before
constexpr const char* function = "reconstruct_contours";

using Neighbors = std::vector<std::array<Index, 2>>;  // -1: none

Neighbors neighbors_of(const Polylines& contours) {
  const Index n = contours.vertices.cols();
  Neighbors neighbors(static_cast<std::size_t>(n), {-1, -1});
  for (Index e = 0; e < contours.edges.cols(); ++e) {
    const Index a = contours.edges(0, e), b = contours.edges(1, e);
    require(a >= 0 && b >= 0 && a < n && b < n, function, "edge", std::to_string(a) + " " + std::to_string(b),
            "its ends must be vertices");
    if (a == b) continue;
    for (const auto& [from, to] : {std::pair{a, b}, std::pair{b, a}}) {
      auto& [first, second] = neighbors[from];
      if (first == to) continue;
      require(second < 0 || second == to, function, "vertex", from,
              "has more than two edges; contours must not branch");
      (first < 0 ? first : second) = to;
    }
    require(contours.vertices.col(a).allFinite() && contours.vertices.col(b).allFinite(), function, "edge", e,
            "coordinates of contours must be finite");
  }
  return neighbors;
}

// The chain from `start` via its neighbour `next`, up to its end or back to the start.
ContourLoop chain(const Neighbors& neighbors, Index start, Index next, std::vector<bool>& seen) {
  ContourLoop loop{start};
  for (Index previous = start; next >= 0 && next != start;) {
    seen[next] = true;
    loop.push_back(next);
    const auto& [first, second] = neighbors[next];
    next = std::exchange(previous, next) == first ? second : first;
  }
  return loop;
}

std::string counted(Index count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? " was" : "s were");
}

// The least-squares plane of a contour.
struct Plane {
  Point<3> center, normal;
  Point<3> aside;        // the first of the points that are far from the centre
  double deviation = 0;  // largest distance of a point
  double size = 0;       // largest distance of a point to the centre
};

Plane fit_plane(const Points<3>& loop, Index number) {
  Plane plane{loop.rowwise().mean(), {}, {}};
  const Points<3> centered = loop.colwise() - plane.center;
  plane.size = centered.colwise().norm().maxCoeff();
  const Eigen::Matrix3d moments = centered * centered.transpose();
  const Eigen::Matrix3d axes = symmetric_eigen(moments).vectors;
  plane.normal = axes.col(0);
  // The signs of the axes depend on the contour alone, so that results turn with it.
  Point<3> area = Point<3>::Zero();
  for (Index i = 0; i < loop.cols(); ++i) {
    const Point<3> p = centered.col(i), next = centered.col((i + 1) % loop.cols());
    area += p.cross(next);
  }
  if (plane.normal.dot(area) < 0) plane.normal = -plane.normal;
  Index first = 0;
  while (centered.col(first).norm() < 0.5 * plane.size) ++first;
  plane.aside = loop.col(first);
  plane.deviation = (plane.normal.transpose() * centered).cwiseAbs().maxCoeff();
  const double width = (axes.col(1).transpose() * centered).cwiseAbs().maxCoeff();
  require(width > least_width * plane.size, function, "contour", number + 1,
          "its points are collinear; a contour must enclose an area");
  require(plane.deviation <= flatness * plane.size, function, "contour", number + 1,
          "is not planar; every contour must lie in a plane");
  return plane;
}

}  // namespace

std::vector<ContourLoop> contour_loops(const Polylines& contours, std::vector<std::string>& warnings) {
  const Neighbors neighbors = neighbors_of(contours);
  std::vector<ContourLoop> loops;
  std::vector<bool> seen(neighbors.size(), false);
  Index opened = 0, small = 0;
  for (Index start = 0; start < std::ssize(neighbors); ++start) {
    const auto& [first, second] = neighbors[start];
    if (seen[start] || first < 0) continue;
    seen[start] = true;
    ContourLoop loop = chain(neighbors, start, first, seen);
    const auto& last = neighbors[loop.back()];
    if (loop.size() < 3 || (last[0] != start && last[1] != start)) {
      // An open chain, entered in its middle or at an end.
      if (second >= 0) {
        const ContourLoop other = chain(neighbors, start, second, seen);
        loop.insert(loop.begin(), other.rbegin(), other.rend() - 1);
      }
      if (loop.size() >= 3) ++opened;
    }
    if (loop.size() < 3)
      ++small;
    else
      loops.push_back(std::move(loop));
  }
  if (opened > 0) warnings.push_back(counted(opened, "open contour") + " closed by a straight segment");
  if (small > 0) warnings.push_back(counted(small, "contour") + " left out for having fewer than three points");
  return loops;
}

bool are_jagged(const Points<3>& points, const std::vector<ContourLoop>& loops) {
  double angles = 0, corners = 0, turns = 0, changes = 0;
  for (const ContourLoop& loop : loops) {
    const auto n = static_cast<Index>(loop.size());
    if (loop.size() < min_corners) continue;
    const Point<3> normal = fit_plane(points(Eigen::all, loop), 0).normal;
    double side = 0;
    for (Index i = 0; i < n; ++i) {
      const auto at = [&](Index k) { return Point<3>(points.col(loop[k % n])); };
      const Point<3> before = at(i + 1) - at(i), after = at(i + 2) - at(i + 1);
      const double turn = std::atan2(normal.dot(before.cross(after)), before.dot(after));
      angles += std::abs(turn);
      ++corners;
      if (std::abs(turn) < straight) continue;
      if (side * turn < 0) ++changes;
      side = turn;
      ++turns;
    }
  }
  return angles > jagged_angle * corners && changes > jagged_share * turns;
}

Slice::Slice(const Point<3>& origin, const Point<3>& normal, const Point<3>& aside) : origin_(origin), normal_(normal) {
  axes_.col(0) = (aside - origin - normal * normal.dot(aside - origin)).normalized();
  axes_.col(1) = normal_.cross(axes_.col(0));
}

void Slice::add(Points<3> loop) {
  const Index n = loop.cols(), old = from_.cols();
  const Points<2> corners = axes_.transpose() * (loop.colwise() - origin_);
  from_.conservativeResize(2, old + n);
  to_.conservativeResize(2, old + n);
  from_.rightCols(n) = corners;
  to_.middleCols(old, n - 1) = corners.rightCols(n - 1);
  to_.rightCols(1) = corners.leftCols(1);
  box_.add(bounding_box<2>(corners));
  loops_.push_back(std::move(loop));
}

double Slice::depth(const Point<2>& q) const {
  bool inside = false;
  double nearest = std::numeric_limits<double>::infinity();
  for (Index i = 0; i < from_.cols(); ++i) {
    const Point<2> a = from_.col(i), ab = to_.col(i) - a, aq = q - a;
    const double length2 = ab.squaredNorm();
    const double t = length2 > 0 ? std::clamp(ab.dot(aq) / length2, 0.0, 1.0) : 0;
    nearest = std::min(nearest, (aq - t * ab).squaredNorm());
    // Does the ray from q along +x cross the segment?
    const bool crosses = (a.y() > q.y()) != (a.y() + ab.y() > q.y());
    if (crosses && aq.x() < ab.x() * aq.y() / ab.y()) inside = !inside;
  }
  return inside ? std::sqrt(nearest) : -std::sqrt(nearest);
}

Slices gather_slices(const Points<3>& points, const std::vector<ContourLoop>& loops) {
  std::vector<Plane> planes;
  for (const ContourLoop& loop : loops) planes.push_back(fit_plane(points(Eigen::all, loop), std::ssize(planes)));
  std::vector<Index> order(loops.size());
  std::iota(order.begin(), order.end(), Index{0});
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return planes[a].size > planes[b].size; });
  Slices result{{}, std::vector<Index>(loops.size())};
  std::vector<double> tolerance;
  for (const Index l : order) {
    Points<3> loop = points(Eigen::all, loops[l]);
    Index s = 0;
    for (; s < std::ssize(result.slices); ++s) {
      const double off =
          (result.slices[s].normal().transpose() * (loop.colwise() - result.slices[s].origin())).cwiseAbs().maxCoeff();
      if (off <= std::max(tolerance[s], deviation_factor * planes[l].deviation)) break;
    }
    if (s == std::ssize(result.slices)) {
      result.slices.emplace_back(planes[l].center, planes[l].normal, planes[l].aside);
      tolerance.push_back(std::max(same_plane, deviation_factor * planes[l].deviation));
    }
    result.slices[s].add(std::move(loop));
    result.slice_of[l] = s;
  }
  return result;
}

}  // namespace csrbf
