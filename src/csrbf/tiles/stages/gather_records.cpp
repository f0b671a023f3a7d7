#include "csrbf/tiles/stages/gather_records.hpp"

namespace csrbf {
namespace {

template <int Dim>
double length(const TileWork<Dim>& work, const Point<Dim>& x) {
  return work.boxed ? x.maxCoeff() : x.norm();  // of coordinates that are not negative
}

template <int Dim>
double distance_to(const TileWork<Dim>& work, const Box<Dim>& box, const Point<Dim>& x) {
  return length<Dim>(work, (box.lo - x).cwiseMax(x - box.hi).cwiseMax(0.0));
}

// Nearest and farthest distance of the points of a box from another box.
template <int Dim>
std::pair<double, double> distances(const TileWork<Dim>& work, const Box<Dim>& box, const Box<Dim>& other) {
  const Point<Dim> nearest = (box.lo - other.hi).cwiseMax(other.lo - box.hi).cwiseMax(0.0);
  const Point<Dim> farthest = (box.lo - other.lo).cwiseMax(other.hi - box.hi).cwiseMax(0.0);
  return {length<Dim>(work, nearest), length<Dim>(work, farthest)};
}

// Adds the points of levels of thinning from `first` to `last`, at the distances that these are for.
template <int Dim>
void add_levels(const TileWork<Dim>& work, const TileFolder& folder, Index tile, int first, int last,
                Records<Dim>& found) {
  const Box<Dim>& own = work.plan.box(tile);
  const auto level_of = [&](double distance) {
    return std::min(level_at(distance, work.halo), work.grid.levels() - 1);
  };
  for (Index t = 0; t < work.plan.size(); ++t) {
    Box<Dim> box = work.plan.box(t);
    box.lo = box.lo.cwiseMax(work.bounds.lo);
    box.hi = box.hi.cwiseMin(work.bounds.hi);
    const auto [nearest, farthest] = distances<Dim>(work, own, box);
    for (int level = std::max(first, level_of(nearest)); level <= std::min(last, level_of(farthest)); ++level) {
      const auto wants_box = [&](const Box<Dim>& block) {
        const auto [near, far] = distances<Dim>(work, own, block);
        return level_of(near) <= level && level <= level_of(far);
      };
      const auto wants_point = [&](const Point<Dim>& p) { return level_of(distance_to<Dim>(work, own, p)) == level; };
      read_tile<Dim>(folder.file("points", t), level, wants_box, wants_point, found);
    }
  }
}

}  // namespace

template <int Dim>
Records<Dim> gather_near(const TileWork<Dim>& work, const TileFolder& folder, Index tile) {
  Records<Dim> found;
  found.each = work.payload;
  add_levels(work, folder, tile, 0, 0, found);
  return found;
}

template <int Dim>
void add_far(const TileWork<Dim>& work, const TileFolder& folder, Index tile, Records<Dim>& near) {
  add_levels(work, folder, tile, 1, work.grid.levels(), near);
}

template <int Dim>
bool has_gaps(const TileWork<Dim>& work, Index tile, const Records<Dim>& near) {
  const Point<Dim> lo = work.plan.box(tile).lo.cwiseMax(work.bounds.lo);
  const Point<Dim> hi = work.plan.box(tile).hi.cwiseMin(work.bounds.hi);
  std::array<Index, Dim> cubes;
  Index all = 1;
  for (int axis = 0; axis < Dim; ++axis) {
    cubes[axis] = static_cast<Index>(std::floor((hi[axis] - lo[axis]) / work.halo));
    if (cubes[axis] < 1 || cubes[axis] > near.size() / all) return true;  // too narrow to tell, or fewer points
    all *= cubes[axis];
  }
  std::vector<char> occupied(static_cast<std::size_t>(all));
  const auto points = near.matrix();
  for (Index i = 0; i < points.cols(); ++i) {
    Index cube = 0;
    bool inside = true;
    for (int axis = Dim - 1; axis >= 0; --axis) {
      const double at = (points(axis, i) - lo[axis]) / (hi[axis] - lo[axis]) * static_cast<double>(cubes[axis]);
      inside = inside && at >= 0 && at < static_cast<double>(cubes[axis]);
      cube = cube * cubes[axis] + static_cast<Index>(inside ? at : 0);
    }
    if (inside) occupied[static_cast<std::size_t>(cube)] = 1;
  }
  return std::count(occupied.begin(), occupied.end(), 0) > 0;
}

template <int Dim>
Records<Dim> thinned_records(const TileWork<Dim>& work, const TileFolder& folder, Index most) {
  const auto all = [](const auto&) { return true; };
  for (int level = 0;; ++level) {
    Records<Dim> found;
    found.each = work.payload;
    for (Index t = 0; t < work.plan.size() && found.size() <= most; ++t)
      read_tile<Dim>(folder.file("points", t), level, all, all, found);
    if (found.size() <= most || level + 1 >= work.grid.levels()) return found;
  }
}

#define CSRBF_INSTANTIATE(Dim)                                                               \
  template Records<Dim> gather_near<Dim>(const TileWork<Dim>&, const TileFolder&, Index);    \
  template void add_far<Dim>(const TileWork<Dim>&, const TileFolder&, Index, Records<Dim>&); \
  template bool has_gaps<Dim>(const TileWork<Dim>&, Index, const Records<Dim>&);             \
  template Records<Dim> thinned_records<Dim>(const TileWork<Dim>&, const TileFolder&, Index);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
