#include "csrbf/surface/prepare/rows.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/core/percentile.hpp"
#include "csrbf/core/small_matrices.hpp"

#include <algorithm>
#include <numbers>
#include <numeric>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr Index row_neighbors = 12;  // the point among them
constexpr double narrow = 0.4;       // spread across a row over that along it
constexpr double share_on_rows = 1.0 / 3;
constexpr Index points_asked = 2000;
constexpr Index fewest_left = 100;

// Neighbourhoods of some points, evenly chosen.
struct Neighborhoods {
  double on_rows = 0;   // share of those that are narrow
  double distance = 0;  // median, of the nearest points
};

Neighborhoods look_around(const Points<3>& points, const KdTree<3>& tree) {
  const Index stride = (points.cols() + points_asked - 1) / points_asked;
  const Index asked = (points.cols() + stride - 1) / stride;
  std::vector<double> distance(asked);
  std::vector<char> is_narrow(asked);
  parallel_for(asked, 256, [&](Index begin, Index end) {
    std::vector<Index> ids(row_neighbors);
    std::vector<double> squared(row_neighbors);
    for (Index i = begin; i < end; ++i) {
      const Index found = tree.nearest(points.col(i * stride), row_neighbors, ids.data(), squared.data());
      Points<3> around = points(Eigen::all, std::span(ids).first(static_cast<std::size_t>(found)));
      around.colwise() -= around.rowwise().mean().eval();
      const Eigen::Vector3d variance = symmetric_eigen_direct(Eigen::Matrix3d(around * around.transpose())).values;
      is_narrow[i] = variance[1] < narrow * narrow * variance[2] ? 1 : 0;
      distance[i] = std::sqrt(squared[1]);
    }
  });
  const auto count = static_cast<double>(std::count(is_narrow.begin(), is_narrow.end(), 1));
  return {count / static_cast<double>(asked), median(std::move(distance))};
}

// Of the points, the first ones that are not nearer to each other than the distance.
std::vector<Index> apart(const Points<3>& points, const KdTree<3>& tree, double distance) {
  std::vector<char> covered(points.cols(), 0);
  std::vector<Index> result, near;
  for (Index i = 0; i < points.cols(); ++i) {
    if (covered[i] != 0) continue;
    result.push_back(i);
    tree.within(points.col(i), distance, near);
    for (const Index j : near) covered[j] = 1;
  }
  return result;
}

}  // namespace

std::vector<Index> all_but_crowded_rows(const Points<3>& points, const KdTree<3>& tree) {
  if (points.cols() < fewest_left) return {};
  Neighborhoods seen = look_around(points, tree);
  if (seen.on_rows < share_on_rows) return {};
  Points<3> left = points;
  std::vector<Index> kept(points.cols());
  std::iota(kept.begin(), kept.end(), Index{0});
  for (double distance = seen.distance; seen.on_rows >= share_on_rows; distance *= std::numbers::sqrt2) {
    const std::vector<Index> chosen = apart(left, KdTree<3>(left), distance);
    if (std::ssize(chosen) < fewest_left) return {};
    for (std::size_t k = 0; k < chosen.size(); ++k) kept[k] = kept[chosen[k]];
    kept.resize(chosen.size());
    left = points(Eigen::all, kept);
    seen = look_around(left, KdTree<3>(left));
  }
  return kept;
}

}  // namespace csrbf
