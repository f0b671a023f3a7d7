#include "csrbf/approx/kriging/thinned_levels.hpp"

#include "csrbf/spatial/chosen_points.hpp"
#include "csrbf/spatial/morton_order.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace csrbf {
namespace {

template <int Dim>
std::size_t cone_of(const Point<Dim>& direction) {
  Index largest = 0;
  direction.cwiseAbs().maxCoeff(&largest);
  std::size_t cone = 2 * static_cast<std::size_t>(largest) + (direction[largest] > 0 ? 1 : 0);
  if constexpr (Dim > 1) {
    Index second = largest == 0 ? 1 : 0;
    for (Index a = 0; a < Dim; ++a)
      if (a != largest && std::abs(direction[a]) > std::abs(direction[second])) second = a;
    const Index among_others = second < largest ? second : second - 1;
    cone = cone * 2 * (Dim - 1) + 2 * static_cast<std::size_t>(among_others) + (direction[second] > 0 ? 1 : 0);
  }
  return cone;
}

}  // namespace

template <int Dim>
ThinnedLevels<Dim>::ThinnedLevels(const Points<Dim>& points) {
  constexpr std::size_t ratio = 4;     // of the sizes of consecutive levels, chosen by hand
  constexpr std::size_t fewest = 100;  // points of a level, chosen by hand: fewer say little about long distances
  std::vector<Index> indices = morton_order<Dim>(points);
  for (;;) {
    Level level{indices, chosen_points<Dim>(points, indices), nullptr};
    levels_.push_back(std::move(level));
    if (indices.size() / ratio < fewest) break;
    std::vector<Index> fewer;
    for (std::size_t i = ratio / 2; i < indices.size(); i += ratio) fewer.push_back(indices[i]);
    indices = std::move(fewer);
  }
  for (Level& level : levels_) level.tree = std::make_unique<const KdTree<Dim>>(level.points);
}

template <int Dim>
std::vector<Index> ThinnedLevels<Dim>::around(const Point<Dim>& x, Index nearest, Index each) const {
  constexpr Index share = 3;  // points of a level that are looked at, of those that may be taken; chosen by hand
  const Index few = std::max(nearest, share * cones * each), all = levels_.back().points.cols();
  std::vector<Index> chosen, found(static_cast<std::size_t>(std::max(few, all)));
  std::vector<double> r2(found.size());
  for (const Level& level : levels_) {
    const bool is_first = &level == levels_.data(), is_last = &level == &levels_.back();
    const auto before = chosen.size();
    const auto look_at = [&](Index points) {  // whether every direction has enough
      chosen.resize(before);
      const Index count = level.tree->nearest(x, points, found.data(), r2.data());
      std::array<Index, cones> taken{};
      for (Index k = 0; k < count; ++k) {
        const Index i = found[static_cast<std::size_t>(k)];
        Index& in_cone = taken[cone_of<Dim>(level.points.col(i) - x)];
        if (in_cone++ < each || (is_first && k < nearest)) chosen.push_back(level.indices[static_cast<std::size_t>(i)]);
      }
      return *std::min_element(taken.begin(), taken.end()) >= each;
    };
    if (!look_at(few) && is_last) look_at(all);
  }
  std::sort(chosen.begin(), chosen.end());
  chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
  return chosen;
}

#define CSRBF_INSTANTIATE(Dim) template class ThinnedLevels<Dim>;
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
