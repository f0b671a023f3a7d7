#include "csrbf/surface/tiles/thinned_points.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/spatial/kd_tree.hpp"

#include <numbers>
#include <numeric>

namespace csrbf {
namespace {

std::uint64_t spread(std::uint64_t x) {
  x &= 0x1FFFFF;
  x = (x | x << 32) & 0x1F00000000FFFF;
  x = (x | x << 16) & 0x1F0000FF0000FF;
  x = (x | x << 8) & 0x100F00F00F00F00F;
  x = (x | x << 4) & 0x10C30C30C30C30C3;
  return (x | x << 2) & 0x1249249249249249;
}

// Of the entries [begin, end) of a curve, the one nearest to their mean.
Index most_central(const PointsRef<3>& points, const std::vector<Index>& order, Index begin, Index end) {
  Point<3> mean = Point<3>::Zero();
  for (Index i = begin; i < end; ++i) mean += points.col(order[i]);
  mean /= static_cast<double>(end - begin);
  Index best = begin;
  double least = std::numeric_limits<double>::infinity();
  for (Index i = begin; i < end; ++i) {
    const double distance = (points.col(order[i]) - mean).squaredNorm();
    if (distance < least) {
      least = distance;
      best = i;
    }
  }
  return best;
}

}  // namespace

ThinningGrid ThinningGrid::over(const Box<3>& box, double spacing) {
  ThinningGrid grid;
  grid.origin = box.lo;
  // A little more than the box, so that its upper faces are inside.
  grid.cube = std::max(box.extent().maxCoeff() * (1 + 1e-9), std::numeric_limits<double>::min()) / (1 << bits);
  const double ratio = std::log2(std::max(1.0, spacing / grid.cube));
  grid.spacing_bits = std::clamp(static_cast<int>(std::lround(ratio)), 0, bits);
  return grid;
}

std::uint64_t ThinningGrid::key(const Point<3>& x) const {
  std::uint64_t key = 0;
  for (int axis = 0; axis < 3; ++axis) {
    constexpr double last = (1 << bits) - 1;
    const double cell = std::clamp(std::floor((x[axis] - origin[axis]) / cube), 0.0, last);
    key |= spread(static_cast<std::uint64_t>(cell)) << axis;
  }
  return key;
}

ThinnedPoints thin(const PointsRef<3>& points, const ThinningGrid& grid) {
  const Index n = points.cols();
  std::vector<std::uint64_t> key(n);
  for (Index i = 0; i < n; ++i) key[i] = grid.key(points.col(i));
  ThinnedPoints result;
  result.order.resize(n);
  std::iota(result.order.begin(), result.order.end(), Index{0});
  std::stable_sort(result.order.begin(), result.order.end(), [&](Index a, Index b) { return key[a] < key[b]; });
  for (int level = 1; level < grid.levels(); ++level) {
    const int shift = std::min(63, 3 * (grid.spacing_bits + level));
    std::vector<Index> chosen;
    for (Index begin = 0, end = 0; begin < n; begin = end) {
      while (end < n && key[result.order[end]] >> shift == key[result.order[begin]] >> shift) ++end;
      chosen.push_back(most_central(points, result.order, begin, end));
    }
    result.levels.push_back(std::move(chosen));
  }
  return result;
}

int level_at(double distance, double halo) {
  if (!(distance > halo)) return 0;
  return static_cast<int>(std::ceil(std::log2(distance / halo)));
}

double typical_spacing(const PointsRef<3>& sample, Index n) {
  constexpr Index neighbors = 9;
  const Index m = sample.cols(), near = std::min(neighbors, m - 1);
  if (near < 1) return 0;
  const KdTree<3> tree(sample);
  std::vector<double> area(m);
  parallel_for(m, 1024, [&](Index begin, Index end) {
    std::vector<Index> ids(near + 1);
    std::vector<double> squared(near + 1);
    for (Index i = begin; i < end; ++i) {
      const Index found = tree.nearest(sample.col(i), near + 1, ids.data(), squared.data());
      area[i] = std::numbers::pi * squared[found - 1] / static_cast<double>(near);
    }
  });
  const auto middle = area.begin() + m / 2;
  std::nth_element(area.begin(), middle, area.end());
  return std::sqrt(*middle * static_cast<double>(m) / static_cast<double>(n));
}

}  // namespace csrbf
