#include "report/near_points.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/spatial/kd_tree.hpp"

#include <array>

namespace csrbf::app {
namespace {

// Chosen by hand: more neighbours smooth more; a larger reach closes gaps in the data, a smaller one opens holes in it.
constexpr Index neighbors = 6;
constexpr double reach = 3;  // relative to the distance from the nearest point to its own neighbours

}  // namespace

Eigen::VectorXd values_near(const PointsRef<3>& points, const Eigen::VectorXd& values, const PointsRef<3>& places) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  Eigen::VectorXd result = Eigen::VectorXd::Constant(places.cols(), none);
  if (points.cols() == 0) return result;
  const KdTree<3> tree(points);
  constexpr Index grain = 256;  // places per task: larger balances worse, smaller costs overhead
  parallel_for(places.cols(), grain, [&](Index begin, Index end) {
    std::array<Index, neighbors> near{}, beside{};
    std::array<double, neighbors> squared{}, spacing{};
    for (Index i = begin; i < end; ++i) {
      const Index found = tree.nearest(places.col(i), neighbors, near.data(), squared.data());
      const Index around = tree.nearest(points.col(near[0]), neighbors, beside.data(), spacing.data());
      if (squared[0] > reach * reach * spacing[around - 1]) continue;
      double sum = 0;
      for (Index k = 0; k < found; ++k) sum += values[near[k]];
      result[i] = sum / static_cast<double>(found);
    }
  });
  return result;
}

}  // namespace csrbf::app
