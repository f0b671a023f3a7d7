#include "csrbf/surface/winding/winding_sum.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/surface/winding/winding_kernels.hpp"

namespace csrbf::winding {
namespace {

constexpr double sum_opening = 2.5;  // radii beyond which a node replaces its samples, by hand: error of w up to 1e-2

struct Lists {
  std::vector<std::int32_t> stack, expansions, leaves;
};

void find_sources(const Tree& tree, const Layer& at, Lists& lists) {
  Box<3> box;
  for (int l = 0; l < layer; ++l) box.add(Point<3>(at.x[0][l], at.x[1][l], at.x[2][l]));
  lists.expansions.clear();
  lists.leaves.clear();
  lists.stack.assign(1, 0);
  while (!lists.stack.empty()) {
    const std::int32_t id = lists.stack.back();
    lists.stack.pop_back();
    const Node& node = tree.nodes[id];
    const Point<3> c(node.center);
    const double gap2 =
        (box.lo - c).cwiseMax(c - box.hi).cwiseMax(0.0).squaredNorm() * node.inverse_scale * node.inverse_scale;
    if (gap2 + node.eps2 > sum_opening * sum_opening) {
      lists.expansions.push_back(id);
    } else if (node.is_leaf()) {
      lists.leaves.push_back(id);
    } else {
      lists.stack.push_back(node.right);
      lists.stack.push_back(id + 1);
    }
  }
}

}  // namespace

Eigen::VectorXf sum_at(const Tree& tree, const PointsRef<3>& x) {
  Eigen::VectorXf w = Eigen::VectorXf::Zero(x.cols());
  if (tree.nodes.empty()) return w;
  parallel_for(x.cols(), 16 * layer, [&](Index begin, Index end) {
    Lists lists;
    for (Index first = begin; first < end; first += layer) {
      Layer at;
      for (int l = 0; l < layer; ++l) {
        const Point<3> y = (x.col(std::min<Index>(first + l, end - 1)) - tree.origin) / tree.unit;
        for (int axis = 0; axis < 3; ++axis) at.x[axis][l] = y[axis];
        at.sum[l] = 0;
      }
      find_sources(tree, at, lists);
      add_sources(tree, lists.expansions, lists.leaves, at);
      for (Index i = first; i < std::min<Index>(first + layer, end); ++i) w[i] = 0.5F * at.sum[i - first];
    }
  });
  return w;
}

}  // namespace csrbf::winding
