#include "csrbf/surface/normals/neighbor_table.hpp"

#include "csrbf/core/parallel.hpp"

namespace csrbf {
namespace {

NeighborTable empty_table(Index n, Index k) {
  NeighborTable table;
  table.k = std::max<Index>(0, std::min(k, n - 1));
  table.index.resize(n * table.k);
  table.reach.setZero(n);
  return table;
}

// Fills the rows for which `known(i)` is false.
template <class Known>
void search(const PointsRef<3>& points, const KdTree<3>& tree, const Known& known, NeighborTable& table) {
  const auto compute = [&](Index begin, Index end) {
    std::vector<Index> ids(table.k + 1);
    std::vector<double> d2(ids.size());
    for (Index i = begin; i < end; ++i) {
      if (known(i)) continue;
      const Index found = tree.nearest(points.col(i), table.k + 1, ids.data(), d2.data());
      table.set(i, {ids.data(), static_cast<std::size_t>(found)}, d2.data());
    }
  };
  parallel_for(points.cols(), 1024, compute);
}

}  // namespace

// Point i need not come first where points coincide, and may be missing.
void NeighborTable::set(Index i, std::span<const Index> ids, const double* squared_distances) {
  Index kept = 0;
  for (Index j = 0; j < std::ssize(ids) && kept < k; ++j) {
    if (ids[j] == i) continue;
    index[i * k + kept++] = static_cast<std::uint32_t>(ids[j]);
    reach[i] = std::sqrt(squared_distances[j]);
  }
}

NeighborTable make_neighbor_table(const PointsRef<3>& points, const KdTree<3>& tree, Index k) {
  NeighborTable table = empty_table(points.cols(), k);
  search(
      points, tree, [](Index) { return false; }, table);
  return table;
}

NeighborTable make_neighbor_table(const PointsRef<3>& points, const KdTree<3>& tree, const NeighborTable& before,
                                  const std::vector<Index>& kept) {
  constexpr auto dropped = std::numeric_limits<std::uint32_t>::max();
  NeighborTable table = empty_table(points.cols(), before.k);
  std::vector<std::uint32_t> now(before.size(), dropped);
  for (std::size_t i = 0; i < kept.size(); ++i) now[kept[i]] = static_cast<std::uint32_t>(i);
  const auto keeps_neighbors = [&](Index i) {
    const std::span<const std::uint32_t> old = before.of(kept[i]);
    if (std::any_of(old.begin(), old.end(), [&](std::uint32_t j) { return now[j] == dropped; })) return false;
    std::transform(old.begin(), old.end(), table.index.begin() + i * table.k, [&](std::uint32_t j) { return now[j]; });
    table.reach[i] = before.reach[kept[i]];
    return true;
  };
  search(points, tree, keeps_neighbors, table);
  return table;
}

}  // namespace csrbf
