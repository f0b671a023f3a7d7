#pragma once

#include "csrbf/core/types.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace csrbf {

template <int Dim>
using InDimension = std::integral_constant<int, Dim>;

/// The dimensions that typed tests run in.
using Dimensions = testing::Types<InDimension<1>, InDimension<2>, InDimension<3>, InDimension<6>>;

/// Squared distance, summed axis by axis.
template <int Dim>
double squared_distance(const Point<Dim>& a, const Point<Dim>& b) {
  double sum = 0;
  for (int axis = 0; axis < Dim; ++axis) {
    const double difference = a[axis] - b[axis];
    sum += difference * difference;
  }
  return sum;
}

template <int Dim>
Points<Dim> uniform_points(Index count, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  return Points<Dim>::NullaryExpr(Dim, count, [&] { return uniform(random); });
}

/// A few tight clusters, of very different widths.
template <int Dim>
Points<Dim> clustered_points(Index count, unsigned seed) {
  const Points<Dim> centers = uniform_points<Dim>(5, seed);
  Points<Dim> points = uniform_points<Dim>(count, seed + 1);
  for (Index i = 0; i < count; ++i)
    points.col(i) = centers.col(i % 5) + std::pow(10.0, -1.0 - static_cast<double>(i % 5)) * points.col(i);
  return points;
}

/// Regular grid in shuffled order: many equal distances, which the exact spacing keeps equal when they are computed.
template <int Dim>
Points<Dim> grid_points(Index count, unsigned seed) {
  const auto side = static_cast<Index>(std::ceil(std::pow(static_cast<double>(count), 1.0 / Dim)));
  Points<Dim> points(Dim, count);
  for (Index i = 0; i < count; ++i) {
    Index rest = i;
    for (int axis = 0; axis < Dim; ++axis, rest /= side) points(axis, i) = .375 * static_cast<double>(rest % side);
  }
  std::mt19937_64 random(seed);
  for (Index i = count - 1; i > 0; --i) {
    const auto j = static_cast<Index>(random() % static_cast<std::uint64_t>(i + 1));
    points.col(i).swap(points.col(j));
  }
  return points;
}

/// Every point several times, far apart in the order.
template <int Dim>
Points<Dim> duplicated_points(Index count, unsigned seed) {
  Points<Dim> points = uniform_points<Dim>(count, seed);
  const Index distinct = std::max<Index>(1, count / 3);
  for (Index i = distinct; i < count; ++i) points.col(i) = points.col(i % distinct);
  return points;
}

template <int Dim>
Points<Dim> collinear_points(Index count, unsigned seed) {
  const Points<1> parameters = uniform_points<1>(count, seed);
  const Point<Dim> direction = uniform_points<Dim>(1, seed + 1).col(0);
  return direction * parameters;
}

/// Named sets of `count` points of every kind above.
template <int Dim>
std::vector<std::pair<std::string, Points<Dim>>> point_sets(Index count) {
  return {{"uniform", uniform_points<Dim>(count, 1)},     {"clustered", clustered_points<Dim>(count, 2)},
          {"grid", grid_points<Dim>(count, 3)},           {"duplicated", duplicated_points<Dim>(count, 4)},
          {"collinear", collinear_points<Dim>(count, 5)}, {"all equal", Points<Dim>::Constant(Dim, count, .3)}};
}

}  // namespace csrbf
