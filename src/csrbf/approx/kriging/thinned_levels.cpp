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
  // Points of a level that are looked at, of those taken: mostly, and where directions have few. Chosen by hand.
  constexpr Index usual_share = 3, share = 16;
  std::vector<Index> chosen, found(static_cast<std::size_t>(std::max(nearest, share * cones * each)));
  std::vector<double> r2(found.size());
  for (const Level& level : levels_) {
    const bool is_first = &level == levels_.data();
    const auto before = chosen.size();
    const auto look_at = [&](Index points) {  // whether every direction has enough, or all points were seen
      chosen.resize(before);
      const Index count = level.tree->nearest(x, points, found.data(), r2.data());
      std::array<Index, cones> taken{};
      for (Index k = 0; k < count; ++k) {
        const Index i = found[static_cast<std::size_t>(k)];
        Index& in_cone = taken[cone_of<Dim>(level.points.col(i) - x)];
        if (in_cone++ < each || (is_first && k < nearest)) chosen.push_back(level.indices[static_cast<std::size_t>(i)]);
      }
      return count < points || *std::min_element(taken.begin(), taken.end()) >= each;
    };
    const Index at_least = is_first ? nearest : 0;
    if (!look_at(std::max(at_least, usual_share * cones * each))) look_at(std::max(at_least, share * cones * each));
  }
  std::sort(chosen.begin(), chosen.end());
  chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
  return chosen;
}

#define CSRBF_INSTANTIATE(Dim) template class ThinnedLevels<Dim>;
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
