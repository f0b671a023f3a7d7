#include "csrbf/levelset/frame/straight_edges.hpp"

#include "csrbf/core/small_matrices.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace csrbf {
namespace {

constexpr double nearly = 0.95;    // of the points; by hand
constexpr double reach = 0.65;     // of a line; faces of voxels are up to half a voxel from the edge that they follow
constexpr double of_circle = 0.9;  // a little more, as that of a circle of voxels
constexpr double of_sector = 1.5;  // its centre is where its sides meet, which is less certain
constexpr double least_angle = 0.2;
constexpr int most = 4;  // lines, as around a rectangle
constexpr int most_planes = 6;
constexpr int trials = 200;             // of lines through points at random
constexpr std::size_t compared = 1500;  // points

struct Plane {
  Point<3> normal;
  double offset;
  [[nodiscard]] bool holds(const Point<3>& p) const { return std::abs(normal.dot(p) - offset) <= reach; }
};

std::vector<Point<3>> some_of(std::span<const Point<3>> points) {
  const std::size_t step = (points.size() + compared - 1) / compared;
  std::vector<Point<3>> result;
  for (std::size_t i = 0; i < points.size(); i += step) result.push_back(points[i]);
  return result;
}

// The one that holds most points, of those through points at random.
Plane best_plane(const std::vector<Point<3>>& points, bool in_plane, std::mt19937_64& random) {
  Plane best{Point<3>::UnitX(), 0};
  std::ptrdiff_t held = -1;
  const auto any = [&]() -> const Point<3>& { return points[random() % points.size()]; };
  for (int trial = 0; trial < trials; ++trial) {
    const Point<3> a = any(), b = any();
    const Point<3> along = in_plane ? Point<3>(Point<3>::UnitZ()) : Point<3>(any() - a);
    const Point<3> normal = (b - a).cross(along);
    if (normal.norm() < 1e-9) continue;
    const Plane plane{normal.normalized(), normal.normalized().dot(a)};
    const auto count = std::count_if(points.begin(), points.end(), [&](const Point<3>& p) { return plane.holds(p); });
    if (count <= held) continue;
    held = count;
    best = plane;
  }
  return best;
}

// By least squares of the points that it holds.
Plane refined(const Plane& plane, const std::vector<Point<3>>& points, bool in_plane) {
  Point<3> mean = Point<3>::Zero();
  double count = 0;
  for (const Point<3>& p : points)
    if (plane.holds(p)) mean += p, count += 1;
  mean /= std::max(count, 1.0);
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (const Point<3>& p : points)
    if (plane.holds(p)) moments += (p - mean) * (p - mean).transpose();
  if (in_plane) moments(2, 2) = 2 * moments.trace() + 1;
  const Point<3> normal = symmetric_eigen(moments).vectors.col(0);
  return {normal, normal.dot(mean)};
}

}  // namespace

bool are_straight(std::span<const Point<3>> points, double least) {
  if (static_cast<double>(points.size()) < least) return false;
  const double scale = static_cast<double>(points.size());
  std::vector<Point<3>> left = some_of(points);
  const double all = static_cast<double>(left.size());
  const bool in_plane = std::all_of(left.begin(), left.end(), [&](const Point<3>& p) { return p[2] == left[0][2]; });
  std::mt19937_64 random(1);  // its sequence is fixed by the standard
  for (int lines = 1; lines <= (in_plane ? most : most_planes); ++lines) {
    if (scale < least * lines) return false;
    Plane plane = best_plane(left, in_plane, random);
    plane = refined(plane, left, in_plane);
    std::erase_if(left, [&](const Point<3>& p) { return plane.holds(p); });
    if (static_cast<double>(left.size()) <= (1 - nearly) * all)
      return lines == 1 || !in_plane || !fit_circle(points, 2).fits;
  }
  return false;
}

bool is_sector(std::span<const Point<3>> points, double least) {
  if (static_cast<double>(points.size()) < 4 * least) return false;
  std::vector<Point<3>> left = some_of(points);
  const double all = static_cast<double>(left.size()), share = all / static_cast<double>(points.size());
  std::mt19937_64 random(1);
  std::array<Plane, 2> sides;
  for (Plane& side : sides) {
    if (left.empty()) return false;
    side = refined(best_plane(left, true, random), left, true);
    const double before = static_cast<double>(left.size());
    std::erase_if(left, [&](const Point<3>& p) { return side.holds(p); });
    if (before - static_cast<double>(left.size()) < least * share) return false;
  }
  const double cross = sides[0].normal[0] * sides[1].normal[1] - sides[0].normal[1] * sides[1].normal[0];
  if (std::abs(cross) < least_angle) return false;
  const double x = (sides[0].offset * sides[1].normal[1] - sides[1].offset * sides[0].normal[1]) / cross;
  const double y = (sides[1].offset * sides[0].normal[0] - sides[0].offset * sides[1].normal[0]) / cross;
  // The other points are at two distances from where the sides meet, at most.
  for (int arc = 0; arc < 2 && static_cast<double>(left.size()) > (1 - nearly) * all; ++arc) {
    std::vector<double> radii;
    for (const Point<3>& p : left) radii.push_back(std::hypot(p[0] - x, p[1] - y));
    std::sort(radii.begin(), radii.end());
    double best = 0, at = 0;
    for (std::size_t i = 0, j = 0; i < radii.size(); ++i) {
      while (radii[i] - radii[j] > 2 * of_sector) ++j;
      if (static_cast<double>(i - j + 1) <= best) continue;
      best = static_cast<double>(i - j + 1);
      at = radii[j];
    }
    std::erase_if(left, [&](const Point<3>& p) {
      const double radius = std::hypot(p[0] - x, p[1] - y);
      return radius >= at && radius <= at + 2 * of_sector;
    });
  }
  return static_cast<double>(left.size()) <= (1 - nearly) * all;
}

FittedCircle fit_circle(std::span<const Point<3>> points, int axis) {
  const int u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
  const auto count = static_cast<double>(points.size());
  Point<3> mean = Point<3>::Zero();
  for (const Point<3>& p : points) mean += p / count;
  // Least squares of x^2 + y^2 - 2 a x - 2 b y - c.
  double xx = 0, xy = 0, yy = 0, rx = 0, ry = 0, r = 0;
  for (const Point<3>& p : points) {
    const double x = p[u] - mean[u], y = p[v] - mean[v], square = x * x + y * y;
    xx += x * x;
    xy += x * y;
    yy += y * y;
    rx += 0.5 * square * x;
    ry += 0.5 * square * y;
    r += square / count;
  }
  const double determinant = xx * yy - xy * xy;
  FittedCircle circle{Point<3>::Zero(), 0, false};
  if (!(determinant > 0)) return circle;
  const double a = (rx * yy - ry * xy) / determinant, b = (ry * xx - rx * xy) / determinant;
  circle.center[u] = mean[u] + a;
  circle.center[v] = mean[v] + b;
  circle.radius = std::sqrt(r + a * a + b * b);
  double near = 0;
  for (const Point<3>& p : points) {
    const double distance = std::hypot(p[u] - circle.center[u], p[v] - circle.center[v]);
    near += std::abs(distance - circle.radius) <= of_circle ? 1 : 0;
  }
  circle.fits = near >= nearly * count;
  return circle;
}

}  // namespace csrbf
