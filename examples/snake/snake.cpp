#include "snake.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <numbers>

using csrbf::Index;
using csrbf::Point;

namespace {

// Points `spacing` apart on the same polygon.
Polygon respaced(const Polygon& points, double spacing) {
  const Index n = points.cols();
  std::vector<double> length(static_cast<std::size_t>(n) + 1, 0.0);
  for (Index i = 0; i < n; ++i)
    length[static_cast<std::size_t>(i) + 1] = length[i] + (points.col((i + 1) % n) - points.col(i)).norm();
  const Index m = std::max<Index>(8, std::lround(length.back() / spacing));
  Polygon result(2, m);
  std::size_t k = 0;
  for (Index j = 0; j < m; ++j) {
    const double at = length.back() * static_cast<double>(j) / static_cast<double>(m);
    while (length[k + 1] < at) ++k;
    const double part = length[k + 1] > length[k] ? (at - length[k]) / (length[k + 1] - length[k]) : 0;
    const auto i = static_cast<Index>(k);
    result.col(j) = (1 - part) * points.col(i) + part * points.col((i + 1) % n);
  }
  return result;
}

// I + step (tension times minus the second difference + stiffness times the fourth), cyclic.
Eigen::MatrixXd internal_matrix(Index n, const SnakeOptions& o) {
  Eigen::MatrixXd A = Eigen::MatrixXd::Identity(n, n);
  for (Index i = 0; i < n; ++i) {
    const auto add = [&](Index offset, double value) { A(i, (i + offset + n) % n) += o.step * value; };
    add(0, 2 * o.tension + 6 * o.stiffness);
    for (const Index side : {-1, 1}) {
      add(side, -o.tension - 4 * o.stiffness);
      add(2 * side, o.stiffness);
    }
  }
  return A;
}

Polygon outward_normals(const Polygon& points) {
  const Index n = points.cols();
  Polygon normals(2, n);
  for (Index i = 0; i < n; ++i) {
    const Point<2> along = points.col((i + 1) % n) - points.col((i + n - 1) % n);
    normals.col(i) = Point<2>(along.y(), -along.x()) / std::max(along.norm(), 1e-9);
  }
  return normals;
}

}  // namespace

Polygon circle(const Point<2>& center, double radius) {
  constexpr Index n = 64;
  Polygon points(2, n);
  for (Index i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / n;
    points.col(i) = center + radius * Point<2>(std::cos(angle), std::sin(angle));
  }
  return points;
}

Polygon move_snake(Polygon points, const SnakeForce& force, const SnakeOptions& options) {
  constexpr int respace_every = 5;
  Eigen::PartialPivLU<Eigen::MatrixXd> internal;
  for (int k = 0; k < options.iterations; ++k) {
    if (k % respace_every == 0) {
      points = respaced(points, options.spacing);
      internal.compute(internal_matrix(points.cols(), options));
    }
    Polygon pull(2, points.cols());
    force(points, outward_normals(points), pull);
    points = internal.solve((points + options.step * pull).transpose()).transpose();
  }
  return points;
}

std::vector<unsigned char> fill(const Polygon& points, Index n) {
  std::vector<unsigned char> labels(n * n, 0);
  std::vector<double> crossings;
  for (Index y = 0; y < n; ++y) {
    const auto row = static_cast<double>(y);
    crossings.clear();
    for (Index i = 0; i < points.cols(); ++i) {
      const Point<2> a = points.col(i), b = points.col((i + 1) % points.cols());
      if ((a.y() <= row) != (b.y() <= row))
        crossings.push_back(a.x() + (row - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
    }
    std::sort(crossings.begin(), crossings.end());
    for (std::size_t c = 0; c + 1 < crossings.size(); c += 2)
      for (Index x = std::max<Index>(0, static_cast<Index>(std::ceil(crossings[c])));
           x < n && static_cast<double>(x) < crossings[c + 1]; ++x)
        labels[x + n * y] = 1;
  }
  return labels;
}
