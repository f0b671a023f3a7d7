#include "csrbf/surface/neighbor_table.hpp"

#include "csrbf/core/parallel.hpp"

namespace csrbf {

NeighborTable make_neighbor_table(const PointsRef<3>& points, const KdTree<3>& tree, Index k) {
  const Index n = points.cols();
  NeighborTable table;
  table.k = std::max<Index>(0, std::min(k, n - 1));
  table.index.resize(static_cast<std::size_t>(n * table.k));
  table.reach.setZero(n);
  parallel_for(n, 1024, [&](Index begin, Index end) {
    std::vector<Index> ids(static_cast<std::size_t>(table.k + 1));
    std::vector<double> d2(ids.size());
    for (Index i = begin; i < end; ++i) {
      const Index found = tree.nearest(points.col(i), table.k + 1, ids.data(), d2.data());
      // The point itself need not come first where points coincide, and may be missing.
      Index kept = 0;
      for (Index j = 0; j < found && kept < table.k; ++j) {
        if (ids[static_cast<std::size_t>(j)] == i) continue;
        table.index[static_cast<std::size_t>(i * table.k + kept++)] =
            static_cast<std::uint32_t>(ids[static_cast<std::size_t>(j)]);
        table.reach[i] = std::sqrt(d2[static_cast<std::size_t>(j)]);
      }
    }
  });
  return table;
}

}  // namespace csrbf
