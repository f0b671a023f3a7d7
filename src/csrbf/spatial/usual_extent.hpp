#pragma once

#include "csrbf/core/percentile.hpp"
#include "csrbf/core/types.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace csrbf {

/// The interval of the middle four fifths of at least one number, extended on both sides by so many times its width.
/// All numbers where those in the middle are equal. O(n).
inline std::pair<double, double> usual_range(std::vector<double> numbers, double widths) {
  constexpr double tail = .1;
  const auto last = static_cast<double>(numbers.size() - 1);
  const double low = order_statistic(numbers, static_cast<Index>(std::ceil(tail * last)));
  const double high = order_statistic(numbers, static_cast<Index>(std::floor((1 - tail) * last)));
  if (!(high > low)) {
    const auto [least, most] = std::minmax_element(numbers.begin(), numbers.end());
    return {*least, *most};
  }
  const double more = widths * (high - low);
  return {low - more, high + more};
}

/// Whether numbers from `least` to `largest` are all within usual_range(), for certain: by how many are in each of some
/// equal parts. It may say no where they are. O(n), without sorting.
template <class Numbers>
bool all_usual(const Numbers& numbers, double least, double largest, double widths) {
  constexpr int parts = 64;
  constexpr double tail = .1;
  const double scale = parts / (largest - least);
  if (!std::isfinite(scale)) return false;
  std::array<Index, parts> count{};
  for (const double x : numbers) ++count[static_cast<std::size_t>(std::min((x - least) * scale, parts - 1.0))];
  const auto part_of = [&](double rank) {
    std::size_t part = 0;
    for (auto up_to = static_cast<double>(count[0]); up_to <= rank; up_to += static_cast<double>(count[part])) ++part;
    return static_cast<double>(part);
  };
  const auto last = static_cast<double>(numbers.size() - 1);
  const double low = part_of(std::ceil(tail * last)), high = part_of(std::floor((1 - tail) * last));
  const double width = high - low - 2;  // in parts, at least: rounding may put a number into the next one
  return width > 0 && low + 2 <= widths * width && high - 1 + widths * width >= parts;
}

/// How many of so many points may be far from the others by mistake.
inline Index few_far(Index points) {
  return std::max<Index>(1, points / 100);
}

/// Along each axis, the extent of the points but for a few (a hundredth, or one) that are far from most of the others:
/// by five widths of the middle four fifths. A wrong coordinate does not change it. 0 where coordinates differ by
/// rounding only. O(n).
template <int Dim>
Point<Dim> usual_extent(const PointsRef<Dim>& points) {
  constexpr double far = 5, rounding = 1e-12;  // chosen by hand
  Point<Dim> extent = Point<Dim>::Zero();
  if (points.cols() == 0) return extent;
  for (int a = 0; a < Dim; ++a) {
    const auto row = points.row(a);
    const double start = row.minCoeff(), end = row.maxCoeff(), all = end - start;
    const double tiny = rounding * std::max(std::abs(start), std::abs(end));
    if (!(all > tiny)) continue;
    if (all_usual(row, start, end, far)) {
      extent[a] = all;
      continue;
    }
    const auto [low, high] = usual_range({row.begin(), row.end()}, far);
    double least = high, most = low;
    Index beyond = 0;
    for (const double x : row) {
      if (x >= low) least = std::min(least, x);
      if (x <= high) most = std::max(most, x);
      beyond += x < low || x > high ? 1 : 0;
    }
    extent[a] = beyond <= few_far(points.cols()) && most - least > tiny ? most - least : all;
  }
  return extent;
}

/// The points, in ascending order, that may have a wrong coordinate: at most a hundredth, or one, that are farther from
/// most of the others than ten widths of the middle four fifths along an axis. None of fewer than ten. O(n).
template <int Dim>
std::vector<Index> far_points(const PointsRef<Dim>& points) {
  constexpr double far = 10, rounding = 1e-12;  // chosen by hand
  constexpr Index fewest = 10;
  std::vector<Index> found;
  if (points.cols() < fewest) return found;
  Eigen::Array<bool, Eigen::Dynamic, 1> is_far = Eigen::Array<bool, Eigen::Dynamic, 1>::Constant(points.cols(), false);
  for (int a = 0; a < Dim; ++a) {
    const auto row = points.row(a);
    if (all_usual(row, row.minCoeff(), row.maxCoeff(), far)) continue;
    const auto [low, high] = usual_range({row.begin(), row.end()}, far);
    if (!(high - low > rounding * row.cwiseAbs().maxCoeff())) continue;
    is_far = is_far || row.transpose().array() < low || row.transpose().array() > high;
  }
  for (Index i = 0; i < is_far.size(); ++i)
    if (is_far[i]) found.push_back(i);
  if (std::ssize(found) > few_far(points.cols())) found.clear();
  return found;
}

/// Ratio of extents from which on axes have units of their own; chosen by hand.
inline constexpr double different_units = 10;

/// The largest extent over the smallest that is not 0; 1 if all are.
template <int Dim>
double ratio_of_extents(const Point<Dim>& extent) {
  const double largest = extent.maxCoeff();
  double smallest = largest;
  for (const double side : extent)
    if (side > 0) smallest = std::min(smallest, side);
  return largest > 0 ? largest / smallest : 1;
}

}  // namespace csrbf
