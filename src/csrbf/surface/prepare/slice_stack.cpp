#include "csrbf/surface/prepare/slice_stack.hpp"

#include "csrbf/core/disjoint_sets.hpp"
#include "csrbf/core/percentile.hpp"
#include "csrbf/core/small_matrices.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <functional>
#include <numeric>
#include <utility>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr Index directions_asked = 1000;   // for directions to their nearest neighbours
constexpr Index planes_tried = 500;        // through two of these
constexpr double within = 0.1;             // sine of the angle to a plane
constexpr double apart_in_plane = 0.3;     // sine of the least angle between directions that define a plane
constexpr double many[] = {0.4, 0.2};      // least share in the planes, of nearest and all; 0.1 of random ones
constexpr double same_plane = 0.9;         // cosine of the angle between normals
constexpr Index few_points = 20000;        // whose slices may be farther apart along than across: ...
constexpr std::size_t planes_of_few = 6;   // ... as many planes are looked at
constexpr double linked[] = {0.1, 0.03};   // largest sine of a step along a slice, in turns
constexpr double thin_slice = 0.3;         // largest part of the usual distance of slices that a slice may be thick
constexpr std::size_t fewest_slices = 3;   // that make a stack
constexpr std::size_t most_of_points = 8;  // a slice has at least so many points in the mean
constexpr double exact = 1e-6;             // of the extent of the points: smaller gaps are none

// Sum of the outer products of the points from their mean.
Eigen::Matrix3d scatter_of(const Points<3>& points) {
  const Points<3> centered = points.colwise() - points.rowwise().mean();
  return centered * centered.transpose();
}

Point<3> flattest(const Eigen::Matrix3d& scatter) {
  return symmetric_eigen(scatter).vectors.col(0);
}

// Directions from points to their nearest `ranks` neighbours.
Points<3> directions_to(const Points<3>& points, const NeighborTable& near, Index ranks) {
  const Index step = (ranks * points.cols() + directions_asked - 1) / directions_asked;
  Points<3> directions(3, ranks * ((points.cols() + step - 1) / step));
  for (Index k = 0; k < directions.cols(); ++k) {
    const Index i = k / ranks * step;
    directions.col(k) = (points.col(near.of(i)[k % ranks]) - points.col(i)).normalized();
  }
  return directions;
}

// Normals of planes that many directions are in, those of most first, at most `count` of them.
std::vector<Point<3>> common_normals(const Points<3>& directions, double least_share, std::size_t count) {
  const Index n = directions.cols();
  std::vector<std::pair<Index, Point<3>>> tried;
  for (Index t = 0; t < planes_tried; ++t) {
    const Point<3> across = directions.col(t * 7919 % n).cross(directions.col((t * 6101 + t / n + 1) % n));
    if (across.norm() < apart_in_plane) continue;
    const Point<3> normal = across.normalized();
    const Index most = ((normal.transpose() * directions).array().abs() < within).count();
    if (static_cast<double>(most) >= least_share * static_cast<double>(n)) tried.emplace_back(most, normal);
  }
  std::stable_sort(tried.begin(), tried.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<Point<3>> different, result;
  for (const auto& most_and_normal : tried) {
    if (result.size() == count) break;
    const Point<3>& best = most_and_normal.second;  // lambdas of C++20 capture no structured binding
    if (std::any_of(different.begin(), different.end(),
                    [&](const Point<3>& d) { return std::abs(d.dot(best)) > same_plane; }))
      continue;
    different.push_back(best);
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (Index k = 0; k < n; ++k)
      if (std::abs(best.dot(directions.col(k))) < within) sum += directions.col(k) * directions.col(k).transpose();
    result.push_back(flattest(sum));
  }
  return result;
}

// Sums over the points of a chain, from its first one.
struct ChainSums {
  double count = 0;
  Point<3> first = Point<3>::Zero(), sum = Point<3>::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();

  void add(const Point<3>& x) {
    if (count == 0) first = x;
    ++count;
    sum += x - first;
    squares += (x - first) * (x - first).transpose();
  }
  [[nodiscard]] Eigen::Matrix3d scatter() const { return squares - sum * sum.transpose() / count; }
};

// The normal of chains of neighbours with steps across `normal`, each in its own plane; none of fewer than three.
std::optional<Point<3>> normal_of_chains(const Points<3>& points, const NeighborTable& near, const Point<3>& normal,
                                         double sine) {
  DisjointSets chains(static_cast<std::size_t>(points.cols()));
  for (Index i = 0; i < points.cols(); ++i)
    for (const std::uint32_t j : near.of(i)) {
      const Point<3> step = points.col(j) - points.col(i);
      if (std::abs(step.dot(normal)) < sine * step.norm()) chains.unite(static_cast<std::uint32_t>(i), j);
    }
  std::vector<ChainSums> sums;
  std::vector<std::size_t> sums_of(static_cast<std::size_t>(points.cols()));  // of chains, by their smallest member
  for (Index i = 0; i < points.cols(); ++i) {
    const std::uint32_t first = chains.find(static_cast<std::uint32_t>(i));
    if (first == i) {
      sums_of[first] = sums.size();
      sums.emplace_back();
    }
    sums[sums_of[first]].add(points.col(i));
  }
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  std::size_t long_enough = 0;
  for (const ChainSums& chain : sums) {
    sum += chain.scatter();
    if (chain.count >= most_of_points) ++long_enough;
  }
  if (long_enough < fewest_slices) return std::nullopt;
  return flattest(sum);
}

Point<3> normal_of(const Points<3>& points, const SliceStack& stack) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (std::size_t s = 0; s < stack.slices(); ++s) sum += scatter_of(points(Eigen::all, stack.slice(s)));
  return flattest(sum);
}

// The gap from which on gaps are those between slices: where gaps in order of size differ most.
double least_between(std::vector<double> gaps, double rounding) {
  std::sort(gaps.begin(), gaps.end(), std::greater<>());
  const std::size_t most = (gaps.size() + 1) / most_of_points;
  double best = 0, largest_ratio = 1;
  for (std::size_t k = fewest_slices - 1; k < std::min(most, gaps.size()); ++k) {
    const double ratio = gaps[k - 1] / std::max(gaps[k], rounding);
    if (ratio <= largest_ratio) continue;
    largest_ratio = ratio;
    best = gaps[k - 1];
  }
  return best;
}

}  // namespace

std::optional<SliceStack> find_slices(const Points<3>& points, const Point<3>& normal) {
  const Eigen::VectorXd height = points.transpose() * normal;
  SliceStack stack;
  stack.order.resize(points.cols());
  std::iota(stack.order.begin(), stack.order.end(), Index{0});
  std::sort(stack.order.begin(), stack.order.end(), [&](Index a, Index b) { return height[a] < height[b]; });
  const auto at = [&](std::size_t k) { return height[stack.order[k]]; };
  const std::size_t n = stack.order.size();
  std::vector<double> gaps;
  for (std::size_t k = 1; k < n; ++k) gaps.push_back(at(k) - at(k - 1));
  if (n == 0) return std::nullopt;
  const double extent = (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
  const double least = least_between(gaps, exact * extent);
  if (!(least > 0)) return std::nullopt;
  std::vector<double> between;
  stack.begin.push_back(0);
  for (std::size_t k = 1; k < n; ++k)
    if (gaps[k - 1] >= least) {
      stack.begin.push_back(k);
      between.push_back(gaps[k - 1]);
    }
  stack.begin.push_back(n);
  if (stack.slices() * most_of_points > n) return std::nullopt;
  stack.apart = median(std::move(between));
  for (std::size_t s = 0; s < stack.slices(); ++s)
    if (at(stack.begin[s + 1] - 1) - at(stack.begin[s]) > thin_slice * stack.apart) return std::nullopt;
  return stack;
}

std::optional<Point<3>> normal_of_slices(const Points<3>& points, const NeighborTable& near) {
  if (near.k == 0) return std::nullopt;
  const auto normal_near = [&](Point<3> normal) -> std::optional<Point<3>> {
    for (const double sine : linked) {
      const std::optional<Point<3>> better = normal_of_chains(points, near, normal, sine);
      if (!better) return std::nullopt;
      normal = *better;
    }
    const std::optional<SliceStack> stack = find_slices(points, normal);
    return stack ? std::optional(normal_of(points, *stack)) : std::nullopt;
  };
  const std::size_t count = points.cols() <= few_points ? planes_of_few : 1;
  for (const bool nearest : {true, false}) {
    const Points<3> directions = directions_to(points, near, nearest ? 1 : near.k);
    const std::vector<Point<3>> found = common_normals(directions, nearest ? many[0] : many[1], count);
    for (const Point<3>& normal : found)
      if (const auto result = normal_near(normal)) return result;
    if (!found.empty() && count == 1) break;
  }
  return std::nullopt;
}

}  // namespace csrbf
