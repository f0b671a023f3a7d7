#include "csrbf/spatial/tile_plan.hpp"

#include "csrbf/core/error.hpp"

#include <numeric>

namespace csrbf {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

template <int Dim>
Box<Dim> all_space() {
  return {Point<Dim>::Constant(-infinity), Point<Dim>::Constant(infinity)};
}

// Cuts the sample at `ids` into tiles first, first + 1, ...; returns the side that stands for them.
template <int Dim>
std::int32_t cut_side(const PointsRef<Dim>& sample, std::span<Index> ids, Index first, Index tiles,
                      std::vector<TileCut>& cuts) {
  if (tiles == 1) return static_cast<std::int32_t>(-1 - first);
  Box<Dim> box;
  for (const Index i : ids) box.add(Point<Dim>(sample.col(i)));
  Index axis = 0;
  box.extent().maxCoeff(&axis);
  const Index below = tiles / 2;
  const auto middle = static_cast<std::size_t>(std::ssize(ids) * below / tiles);
  const auto before = [&](Index a, Index b) {
    return sample(axis, a) < sample(axis, b) || (sample(axis, a) == sample(axis, b) && a < b);
  };
  std::nth_element(ids.begin(), ids.begin() + static_cast<std::ptrdiff_t>(middle), ids.end(), before);
  const auto number = cuts.size();
  cuts.push_back({static_cast<std::int32_t>(axis), 0, 0, sample(axis, ids[middle])});
  const std::int32_t left = cut_side<Dim>(sample, ids.first(middle), first, below, cuts);
  const std::int32_t right = cut_side<Dim>(sample, ids.subspan(middle), first + below, tiles - below, cuts);
  cuts[number].below = left;
  cuts[number].above = right;
  return static_cast<std::int32_t>(number);
}

}  // namespace

template <int Dim>
TilePlan<Dim>::TilePlan(std::vector<TileCut> cuts, double blend) : cuts_(std::move(cuts)), blend_(blend) {
  require(std::isfinite(blend) && blend >= 0, "TilePlan", "blend", blend, "must be a length");
  boxes_.assign(cuts_.size() + 1, Box<Dim>{});
  std::vector<Box<Dim>> box(cuts_.size(), all_space<Dim>());
  if (cuts_.empty()) boxes_.front() = all_space<Dim>();
  for (std::size_t i = 0; i < cuts_.size(); ++i) {
    const TileCut& c = cuts_[i];
    require(c.axis >= 0 && c.axis < Dim && std::isfinite(c.at), "TilePlan", "cut", i, "must be across an axis");
    for (const std::int32_t side : {c.below, c.above}) {
      const bool leaf = side < 0;
      const auto number = static_cast<std::size_t>(leaf ? -1 - side : side);
      require(leaf ? number < boxes_.size() : number > i && number < cuts_.size(), "TilePlan", "cut", i,
              "must have sides that follow");
      Box<Dim> part = box[i];
      (side == c.below ? part.hi : part.lo)[c.axis] = c.at;
      (leaf ? boxes_ : box)[number] = part;
    }
  }
  for (const Box<Dim>& b : boxes_) require(!b.empty(), "TilePlan", "cuts", cuts_.size(), "must reach every tile");
}

template <int Dim>
Index TilePlan<Dim>::tile_of(const Point<Dim>& x) const {
  if (cuts_.empty()) return 0;
  std::int32_t side = 0;
  while (side >= 0) side = x[cuts_[side].axis] < cuts_[side].at ? cuts_[side].below : cuts_[side].above;
  return -1 - side;
}

template <int Dim>
std::vector<Index> TilePlan<Dim>::tiles_in(const Box<Dim>& box) const {
  std::vector<Index> found;
  std::vector<std::int32_t> open{cuts_.empty() ? -1 : 0};
  while (!open.empty()) {
    const std::int32_t side = open.back();
    open.pop_back();
    if (side < 0) {
      found.push_back(-1 - side);
      continue;
    }
    const TileCut& c = cuts_[side];
    if (box.hi[c.axis] >= c.at) open.push_back(c.above);
    if (box.lo[c.axis] <= c.at) open.push_back(c.below);
  }
  std::sort(found.begin(), found.end());
  return found;
}

template <int Dim>
bool TilePlan<Dim>::is_deep(const Point<Dim>& x, Index tile) const {
  const Box<Dim>& b = boxes_[tile];
  return (x.array() > b.lo.array() + blend_).all() && (x.array() < b.hi.array() - blend_).all();
}

template <int Dim>
std::vector<TileCut> cut_into_tiles(const PointsRef<Dim>& sample, Index tiles) {
  require(tiles >= 1 && tiles <= sample.cols(), "cut_into_tiles", "tiles", tiles,
          "must be between 1 and the number of points");
  std::vector<Index> ids(sample.cols());
  std::iota(ids.begin(), ids.end(), Index{0});
  std::vector<TileCut> cuts;
  cut_side<Dim>(sample, ids, 0, tiles, cuts);
  return cuts;
}

#define CSRBF_INSTANTIATE(Dim)  \
  template class TilePlan<Dim>; \
  template std::vector<TileCut> cut_into_tiles<Dim>(const PointsRef<Dim>&, Index);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
