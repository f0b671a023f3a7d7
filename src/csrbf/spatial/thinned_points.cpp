#include "csrbf/spatial/thinned_points.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/core/percentile.hpp"
#include "csrbf/spatial/kd_tree.hpp"
#include "csrbf/spatial/morton_code.hpp"
#include "csrbf/spatial/radix_sort.hpp"

#include <algorithm>
#include <numbers>

namespace csrbf {
namespace {

// Of the points [begin, end), the one nearest to their mean.
template <int Dim>
Index most_central(const Points<Dim>& points, Index begin, Index end) {
  if (end - begin == 1) return begin;
  Point<Dim> mean = Point<Dim>::Zero();
  for (Index i = begin; i < end; ++i) mean += points.col(i);
  mean /= static_cast<double>(end - begin);
  Index best = begin;
  double least = std::numeric_limits<double>::infinity();
  for (Index i = begin; i < end; ++i) {
    const double distance = (points.col(i) - mean).squaredNorm();
    if (distance < least) {
      least = distance;
      best = i;
    }
  }
  return best;
}

// The numbers of the points in ascending order of their keys, and these. Equal keys keep their order.
template <int Dim>
std::vector<std::uint64_t> sort_by_key(const PointsRef<Dim>& points, const ThinningGrid<Dim>& grid,
                                       std::vector<Index>& order) {
  const auto n = static_cast<std::size_t>(points.cols());
  std::vector<std::uint64_t> key(n), sorted(n);
  std::vector<Keyed> items(n);
  for (std::size_t i = 0; i < n; ++i) {
    key[i] = grid.key(points.col(static_cast<Index>(i)));
    items[i] = {static_cast<std::uint32_t>(key[i]), static_cast<std::uint32_t>(i)};
  }
  radix_sort(items);
  std::uint32_t largest = 0;
  for (Keyed& item : items) largest = std::max(largest, item.key = static_cast<std::uint32_t>(key[item.index] >> 32));
  radix_sort(items, largest);
  order.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    order[i] = items[i].index;
    sorted[i] = key[items[i].index];
  }
  return sorted;
}

}  // namespace

template <int Dim>
ThinningGrid<Dim> ThinningGrid<Dim>::over(const Box<Dim>& box, double spacing) {
  ThinningGrid grid;
  grid.origin = box.lo;
  // A little more than the box, so that its upper faces are inside.
  grid.cube =
      std::max(box.extent().maxCoeff() * (1 + 1e-9), std::numeric_limits<double>::min()) / std::ldexp(1.0, bits);
  const double ratio = std::log2(std::max(1.0, spacing / grid.cube));
  grid.spacing_bits = std::clamp(static_cast<int>(std::lround(ratio)), 0, bits);
  return grid;
}

template <int Dim>
std::uint64_t ThinningGrid<Dim>::key(const Point<Dim>& x) const {
  const double last = std::ldexp(1.0, bits) - 1;
  std::array<std::uint64_t, Dim> cell;
  for (int axis = 0; axis < Dim; ++axis)
    cell[axis] = static_cast<std::uint64_t>(std::clamp(std::floor((x[axis] - origin[axis]) / cube), 0.0, last));
  return morton_code<Dim>(cell, bits);
}

template <int Dim>
ThinnedPoints thin(const PointsRef<Dim>& points, const ThinningGrid<Dim>& grid) {
  const Index n = points.cols();
  ThinnedPoints result;
  std::vector<std::uint64_t> key = sort_by_key(points, grid, result.order);
  const Points<Dim> sorted = points(Eigen::all, result.order);
  for (int level = 1; level < grid.levels(); ++level) {
    const int shift = std::min(63, Dim * (grid.spacing_bits + level));
    std::vector<Index> chosen;
    for (Index begin = 0, end = 0; begin < n; begin = end) {
      while (end < n && key[end] >> shift == key[begin] >> shift) ++end;
      chosen.push_back(most_central<Dim>(sorted, begin, end));
    }
    result.levels.push_back(std::move(chosen));
  }
  return result;
}

int level_at(double distance, double halo) {
  if (!(distance > halo)) return 0;
  return static_cast<int>(std::ceil(std::log2(distance / halo)));
}

template <int Dim>
double typical_spacing(const PointsRef<Dim>& sample, Index n, int dimension) {
  constexpr Index neighbors = 9;
  constexpr Index most_asked =
      1 << 14;  // points whose volume is found: their median has an error below half a per cent
  const Index m = sample.cols(), near = std::min(neighbors, m - 1);
  if (near < 1) return 0;
  const Index stride = (m + most_asked - 1) / most_asked, asked = (m + stride - 1) / stride;
  const KdTree<Dim> tree(sample);
  // The volume of each point: that of a ball around it, divided among those in it.
  const double unit_ball = std::pow(std::numbers::pi, dimension / 2.0) / std::tgamma(dimension / 2.0 + 1);
  std::vector<double> volume(asked);
  parallel_for(asked, 1024, [&](Index begin, Index end) {
    std::vector<Index> ids(near + 1);
    std::vector<double> squared(near + 1);
    for (Index i = begin; i < end; ++i) {
      const Index found = tree.nearest(sample.col(i * stride), near + 1, ids.data(), squared.data());
      volume[i] = unit_ball * std::pow(squared[found - 1], dimension / 2.0) / static_cast<double>(near);
    }
  });
  return std::pow(median(volume) * static_cast<double>(m) / static_cast<double>(n), 1.0 / dimension);
}

#define CSRBF_INSTANTIATE(Dim)                                                                   \
  template struct ThinningGrid<Dim>;                                                             \
  template ThinnedPoints thin<Dim>(const PointsRef<Dim>& points, const ThinningGrid<Dim>& grid); \
  template double typical_spacing<Dim>(const PointsRef<Dim>&, Index, int);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
