#include "csrbf/core/field.hpp"

#include "csrbf/core/grid_tiles.hpp"
#include "csrbf/core/parallel.hpp"

namespace csrbf {

template <int Dim>
Jet<Dim> Field<Dim>::evaluate_in(const std::vector<Index>& order, const PointsRef<Dim>& x,
                                 Derivatives derivatives) const {
  Jet<Dim> jet(x.cols(), derivatives);
  parallel_for(x.cols(), ordered_block_size(x.cols()), [&](Index begin, Index end) {
    const Index n = end - begin;
    Points<Dim> block(Dim, n);
    Jet<Dim> part(n, derivatives);
    for (Index i = 0; i < n; ++i) block.col(i) = x.col(order[begin + i]);
    evaluate_block(block, {part.value.data(), part.gradient.data(), part.hessian.data()});
    for (Index i = 0; i < n; ++i) {
      const Index to = order[begin + i];
      jet.value[to] = part.value[i];
      if (derivatives >= Derivatives::gradient) jet.gradient.col(to) = part.gradient.col(i);
      if (derivatives >= Derivatives::hessian) jet.hessian.col(to) = part.hessian.col(i);
    }
  });
  return jet;
}

template <int Dim>
Jet<Dim> Field<Dim>::evaluate(const PointsRef<Dim>& x, Derivatives derivatives) const {
  if (x.cols() > block_size) {
    const std::vector<Index> order = evaluation_order(x);
    if (!order.empty()) return evaluate_in(order, x, derivatives);
  }
  Jet<Dim> jet(x.cols(), derivatives);
  const JetBlock out{jet.value.data(), jet.gradient.data(), jet.hessian.data()};
  parallel_for(x.cols(), block_size,
               [&](Index begin, Index end) { evaluate_block(x.middleCols(begin, end - begin), out.from<Dim>(begin)); });
  return jet;
}

template <int Dim>
Eigen::VectorXd Field<Dim>::evaluate_grid(const GridAxes<Dim>& axes) const {
  const GridTiles<Dim> tiles(axes, block_size);
  Eigen::VectorXd value(tiles.nodes());
  if (value.size() == 0) return value;
  parallel_for(tiles.size(), 1, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      const GridTile<Dim> tile = tiles[i];
      Points<Dim> block(Dim, tile.nodes());
      Eigen::VectorXd part(tile.nodes());
      Index k = 0;
      tiles.for_each_row(tile, [&](std::array<Index, Dim> node, Index /*first*/) {
        for (; node[0] < tile.end[0]; ++node[0], ++k)
          for (Index a = 0; a < Dim; ++a) block(a, k) = axes[a][node[a]];
      });
      evaluate_block(block, {part.data(), nullptr, nullptr});
      const double* from = part.data();
      tiles.for_each_row(tile, [&](const std::array<Index, Dim>& /*node*/, Index first) {
        std::copy_n(from, tile.size(0), value.data() + first);
        from += tile.size(0);
      });
    }
  });
  return value;
}

#define CSRBF_INSTANTIATE(Dim) template class Field<Dim>;
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
