#include "csrbf/approx/kriging/thinned_levels.hpp"

#include "csrbf/spatial/morton_order.hpp"

#include <algorithm>

namespace csrbf {

template <int Dim>
ThinnedLevels<Dim>::ThinnedLevels(const Points<Dim>& points) {
  constexpr std::size_t ratio = 4;     // of the sizes of consecutive levels, chosen by hand
  constexpr std::size_t fewest = 100;  // points of a level, chosen by hand: fewer say little about long distances
  std::vector<Index> indices = morton_order<Dim>(points);
  for (;;) {
    Level level{indices, points(Eigen::all, indices), nullptr};
    levels_.push_back(std::move(level));
    if (indices.size() / ratio < fewest) break;
    std::vector<Index> fewer;
    for (std::size_t i = ratio / 2; i < indices.size(); i += ratio) fewer.push_back(indices[i]);
    indices = std::move(fewer);
  }
  for (Level& level : levels_) level.tree = std::make_unique<const KdTree<Dim>>(level.points);
}

template <int Dim>
std::vector<Index> ThinnedLevels<Dim>::around(const Point<Dim>& x, Index each) const {
  std::vector<Index> found, nearest(static_cast<std::size_t>(each));
  std::vector<double> r2(nearest.size());
  for (const Level& level : levels_) {
    const Index count = level.tree->nearest(x, each, nearest.data(), r2.data());
    for (Index k = 0; k < count; ++k) found.push_back(level.indices[static_cast<std::size_t>(nearest[k])]);
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

#define CSRBF_INSTANTIATE(Dim) template class ThinnedLevels<Dim>;
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
