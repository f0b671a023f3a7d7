#include "csrbf/surface/prepare/rows.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/core/percentile.hpp"
#include "csrbf/core/small_matrices.hpp"

#include <algorithm>
#include <atomic>
#include <numbers>
#include <numeric>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr Index row_neighbors = 12;  // the point among them
constexpr double narrow = 0.4;       // spread across a row over that along it
constexpr double many_on_rows = 1.0 / 3;
constexpr Index wide_neighbors = 128;  // among which those apart are sought
constexpr Index points_asked = 2000;
constexpr Index fewest_left = 100;

// Of points ordered by their distance from the first one, the first `row_neighbors` that are `distance` apart.
Points<3> nearest_apart(const Points<3>& points, double distance) {
  Points<3> result(3, row_neighbors);
  Index count = 0;
  for (Index i = 0; i < points.cols() && count < row_neighbors; ++i)
    if (count == 0 ||
        (result.leftCols(count).colwise() - points.col(i)).colwise().squaredNorm().minCoeff() >= distance * distance)
      result.col(count++) = points.col(i);
  return result.leftCols(count);
}

bool is_narrow(Points<3> around) {
  around.colwise() -= around.rowwise().mean().eval();
  const Eigen::Vector3d variance = symmetric_eigen_direct(Eigen::Matrix3d(around * around.transpose())).values;
  return variance[1] < narrow * narrow * variance[2];
}

// The points that are asked.
struct Sample {
  Index stride, count;
  explicit Sample(const Points<3>& points)
      : stride((points.cols() + points_asked - 1) / points_asked), count((points.cols() + stride - 1) / stride) {}
};

double nearest_distance(const Points<3>& points, const KdTree<3>& tree) {
  const Sample asked(points);
  std::vector<double> distance(asked.count);
  for (Index i = 0; i < asked.count; ++i) {
    Index ids[2];
    double squared[2];
    tree.nearest(points.col(i * asked.stride), 2, ids, squared);
    distance[i] = std::sqrt(squared[1]);
  }
  return median(std::move(distance));
}

// Share of the points whose neighbours are narrow, all of them or those that are twice the distance apart.
double share_on_rows(const Points<3>& points, const KdTree<3>& tree, double distance) {
  const Sample asked(points);
  std::atomic<Index> all = 0, apart = 0;
  parallel_for(asked.count, 256, [&](Index begin, Index end) {
    std::vector<Index> ids(wide_neighbors);
    std::vector<double> squared(wide_neighbors);
    for (Index i = begin; i < end; ++i) {
      const Index found = tree.nearest(points.col(i * asked.stride), wide_neighbors, ids.data(), squared.data());
      const Points<3> around = points(Eigen::all, std::span(ids).first(static_cast<std::size_t>(found)));
      all += is_narrow(around.leftCols(std::min(found, row_neighbors))) ? 1 : 0;
      apart += is_narrow(nearest_apart(around, 2 * distance)) ? 1 : 0;
    }
  });
  return static_cast<double>(std::max(all, apart)) / static_cast<double>(asked.count);
}

}  // namespace

std::vector<Index> all_but_crowded_rows(const Points<3>& points, const KdTree<3>& tree) {
  if (points.cols() < fewest_left) return {};
  double distance = nearest_distance(points, tree);
  if (share_on_rows(points, tree, distance) < many_on_rows) return {};
  Points<3> left = points;
  std::vector<Index> kept(points.cols());
  std::iota(kept.begin(), kept.end(), Index{0});
  do {
    const std::vector<Index> chosen = points_apart(left, KdTree<3>(left), distance);
    if (std::ssize(chosen) < fewest_left) return {};
    for (std::size_t k = 0; k < chosen.size(); ++k) kept[k] = kept[chosen[k]];
    kept.resize(chosen.size());
    left = points(Eigen::all, kept);
    distance *= std::numbers::sqrt2;
  } while (share_on_rows(left, KdTree<3>(left), distance) >= many_on_rows);
  return kept;
}

}  // namespace csrbf
