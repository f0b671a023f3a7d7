#include "csrbf/levelset/objects/bent_shapes.hpp"

#include "csrbf/core/small_matrices.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

namespace csrbf {
namespace {

constexpr double straight = 20, ring = 0.8;  // radii of an arc over the deviation along it, at most and at least
constexpr double elongated = 1.3;            // deviations of what may be bent, at least; a thin half ring has 2.3
constexpr int arc_rounds = 4, rod_rounds = 20;

struct Arc {
  double x, y, radius;
};

Point<3> mean_of(std::span<const Point<3>> points) {
  Point<3> sum = Point<3>::Zero();
  for (const Point<3>& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

// About their mean: along the longest axis, along the one in which they are bent, across both. Empty where no axis is
// clearly the longest.
std::vector<Point<3>> along_axes(std::span<const Point<3>> points, int dim) {
  const Point<3> mean = mean_of(points);
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Point<3>& p : points) spread += (p - mean) * (p - mean).transpose();
  const SymmetricEigen found = symmetric_eigen(spread);
  if (found.values[2] < elongated * elongated * found.values[1]) return {};
  const SmallMatrix& axes = found.vectors;  // of two dimensions: across them first
  Eigen::Matrix3d turn;
  turn << axes.col(2), axes.col(1), axes.col(0);
  if (dim == 3) {
    Eigen::Vector2d bend = Eigen::Vector2d::Zero();
    const double mean_square = spread.trace() > 0 ? turn.col(0).dot(spread * turn.col(0)) : 0;
    const double n = static_cast<double>(points.size());
    for (const Point<3>& p : points) {
      const Point<3> q = turn.transpose() * (p - mean);
      bend += (q.x() * q.x() - mean_square / n) * q.tail<2>();
    }
    if (bend.norm() > 0) {
      bend.normalize();
      const Point<3> along = turn.rightCols<2>() * bend;
      turn.col(2) = turn.rightCols<2>() * Eigen::Vector2d(-bend.y(), bend.x());
      turn.col(1) = along;
    }
  }
  std::vector<Point<3>> result;
  result.reserve(points.size());
  for (const Point<3>& p : points) result.emplace_back(turn.transpose() * (p - mean));
  return result;
}

// Of least squares of the squared distances first, which makes the radii of thick arcs too small, then of the
// distances.
std::optional<Arc> fit_arc(std::span<const Point<3>> points) {
  const double n = static_cast<double>(points.size());
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  double squares = 0;
  for (const Point<3>& p : points) {
    const Eigen::Vector3d row(2 * p.x(), 2 * p.y(), 1);
    A += row * row.transpose();
    b += row * p.head<2>().squaredNorm();
    squares += p.x() * p.x();
  }
  const double deviation = std::sqrt(squares / n);
  if (!(std::abs(A.determinant()) > 0)) return {};
  const Eigen::Vector3d first = A.inverse() * b;
  Arc arc{first.x(), first.y(), std::sqrt(std::max(0.0, first.z() + first.head<2>().squaredNorm()))};
  if (!(arc.radius < 1.5 * straight * deviation)) return {};
  for (int round = 0; round < arc_rounds; ++round) {
    Eigen::Vector2d mean = Eigen::Vector2d::Zero(), products = Eigen::Vector2d::Zero();
    Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
    double radius = 0;
    for (const Point<3>& p : points) {
      const Eigen::Vector2d off = p.head<2>() - Eigen::Vector2d(arc.x, arc.y);
      const double distance = off.norm();
      if (!(distance > 0)) continue;
      const Eigen::Vector2d slope = off / distance;
      mean += slope;
      spread += slope * slope.transpose();
      products += slope * distance;
      radius += distance;
    }
    arc.radius = radius / n;
    if (!(arc.radius < 1.5 * straight * deviation)) return {};
    spread -= mean * mean.transpose() / n;
    if (!(spread.determinant() > 0)) return {};
    const Eigen::Vector2d step = spread.inverse() * (products - mean * arc.radius);
    arc.x += step.x();
    arc.y += step.y();
  }
  double radius = 0;
  for (const Point<3>& p : points) radius += std::hypot(p.x() - arc.x, p.y() - arc.y);
  arc.radius = radius / n;
  if (!(arc.radius <= straight * deviation && arc.radius >= ring * deviation)) return {};
  return arc;
}

// Unrolls an arc: areas stay what they are.
void straighten(std::vector<Point<3>>& points, const Arc& arc) {
  const double side = arc.y > 0 ? -1 : 1;  // from the middle of the arc's circle to the points
  for (Point<3>& p : points) {
    const double x = p.x() - arc.x, y = side * (p.y() - arc.y);
    p.x() = arc.radius * std::atan2(x, y);
    p.y() = (x * x + y * y - arc.radius * arc.radius) / (2 * arc.radius);
  }
}

// Squared radius of a rod with that deviation across it; none of what is shorter than wide.
std::optional<double> rod_radius(double variance, double size, int dim) {
  if (dim == 2) {
    const double root = size * size / 9 - std::numbers::pi * size * variance / 3;
    if (!(root > 0)) return {};
    return (size / 3 - std::sqrt(root)) / (std::numbers::pi / 6);
  }
  const double ball = std::pow(3 * size / (4 * std::numbers::pi), 2.0 / 3);
  double square = 4 * variance;
  for (int round = 0; round < rod_rounds && square < ball; ++round)
    square = 4 * (variance + std::numbers::pi * std::pow(square, 2.5) / (15 * size));
  if (!(square < ball)) return {};
  return square;
}

}  // namespace

BentShapes fit_bent_shapes(std::span<const Point<3>> points, double size, double voxel, int dim) {
  BentShapes result;
  std::vector<Point<3>> x = along_axes(points, dim);
  const std::optional<Arc> arc = x.empty() ? std::nullopt : fit_arc(x);
  if (!arc) return result;
  straighten(x, *arc);
  const Point<3> mean = mean_of(x);
  Point<3> variance = Point<3>::Zero();
  for (Point<3>& p : x) {
    p -= mean;
    variance += p.cwiseAbs2();
  }
  const double n = static_cast<double>(x.size());
  variance = variance / n + Point<3>::Constant(std::pow(voxel, 2.0 / dim) / 12);
  if (dim == 2) variance.z() = 1;
  const double ball = dim == 3 ? 4 * std::numbers::pi / 3 : std::numbers::pi;
  const double ellipsoid = ball * std::pow(dim + 2, 0.5 * dim) * std::sqrt(variance.prod());
  const double bound = (dim + 2) * std::pow(size / ellipsoid, 2.0 / dim);
  double outside = 0;
  for (const Point<3>& p : x) outside += p.cwiseAbs2().cwiseQuotient(variance).sum() > bound ? 1 : 0;
  result.ellipsoid = outside / n;
  // Across a rod, both deviations count as one.
  const double ratio = dim == 3 ? std::sqrt(variance.z() / variance.y()) : 1;
  const std::optional<double> square = rod_radius(variance.y() * ratio, size, dim);
  if (!square) return result;
  const double radius = std::sqrt(*square);
  const double half = dim == 2
                          ? (size - std::numbers::pi * *square) / (4 * radius)
                          : (size - 4 * std::numbers::pi / 3 * *square * radius) / (2 * std::numbers::pi * *square);
  if (!(half > 0)) return result;
  outside = 0;
  for (const Point<3>& p : x) {
    const double beyond = std::max(0.0, std::abs(p.x()) - half);
    outside += beyond * beyond + p.y() * p.y() * ratio + p.z() * p.z() / ratio > *square ? 1 : 0;
  }
  result.rod = outside / n;
  return result;
}

}  // namespace csrbf
