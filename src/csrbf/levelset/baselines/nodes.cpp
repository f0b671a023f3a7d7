#include "csrbf/levelset/baselines/nodes.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/spatial/kd_tree.hpp"

#include <Eigen/Geometry>

namespace csrbf {
namespace {

// Nodes at `map` of the box [0, last].
template <int Dim, class Map>
Nodes<Dim> make_nodes(const Point<Dim>& last, const std::array<Index, Dim>& counts, const Map& map) {
  Index n = 1;
  for (const Index count : counts) {
    require(count >= 2, "regular_nodes", "number of nodes along an axis", count, "must be at least 2");
    n *= count;
  }
  Nodes<Dim> nodes{Points<Dim>(Dim, n), counts};
  for (Index i = 0; i < n; ++i) {
    Index rest = i;
    Point<Dim> p;
    for (Index a = 0; a < Dim; ++a) {
      p[a] = last[a] * static_cast<double>(rest % counts[a]) / static_cast<double>(counts[a] - 1);
      rest /= counts[a];
    }
    nodes.points.col(i) = map(p);
  }
  return nodes;
}

}  // namespace

template <int Dim>
Nodes<Dim> regular_nodes(const Grid& grid, const std::array<Index, Dim>& counts) {
  Point<Dim> last;
  for (Index a = 0; a < Dim; ++a) last[a] = static_cast<double>(grid.size[a] - 1);
  const auto map = grid.to_physical<Dim>();
  return make_nodes<Dim>(last, counts, [&](const Point<Dim>& p) -> Point<Dim> { return map * p; });
}

template <int Dim>
Nodes<Dim> regular_nodes(const Grid& grid, double spacing) {
  require(spacing > 0 && std::isfinite(spacing), "regular_nodes", "spacing", spacing, "must be positive");
  const double step = spacing * grid.spacing.head<Dim>().minCoeff();
  std::array<Index, Dim> counts;
  for (Index a = 0; a < Dim; ++a) {
    const double length = static_cast<double>(grid.size[a] - 1) * grid.spacing[a];
    counts[a] = std::max<Index>(2, std::lround(length / step) + 1);
  }
  return regular_nodes<Dim>(grid, counts);
}

template <int Dim>
Nodes<Dim> regular_nodes(const Box<Dim>& box, const std::array<Index, Dim>& counts) {
  return make_nodes<Dim>(box.extent(), counts, [&](const Point<Dim>& p) -> Point<Dim> { return box.lo + p; });
}

template <int Dim>
double fill_distance(const Nodes<Dim>& nodes, const PointsRef<Dim>& domain) {
  require(nodes.points.cols() >= 2, "fill_distance", "number of nodes", nodes.points.cols(), "must be at least 2");
  if (nodes.regular()) {
    Point<Dim> diagonal = Point<Dim>::Zero();
    Index stride = 1;
    for (Index a = 0; a < Dim; stride *= nodes.size[a], ++a) diagonal += nodes.points.col(stride) - nodes.points.col(0);
    return 0.5 * diagonal.norm();
  }
  constexpr Index grain = 4096;  // searches per task
  const KdTree<Dim> tree(nodes.points);
  std::vector<double> largest((domain.cols() + grain - 1) / grain, 0.0);
  parallel_for(domain.cols(), grain, [&](Index begin, Index end) {
    double& worst = largest[begin / grain];
    for (Index i = begin; i < end; ++i) {
      Index nearest = 0;
      double squared = 0;
      tree.nearest(domain.col(i), 1, &nearest, &squared);
      worst = std::max(worst, squared);
    }
  });
  return largest.empty() ? 0 : std::sqrt(*std::max_element(largest.begin(), largest.end()));
}

#define CSRBF_INSTANTIATE(Dim)                                                            \
  template Nodes<Dim> regular_nodes<Dim>(const Grid&, const std::array<Index, Dim>&);     \
  template Nodes<Dim> regular_nodes<Dim>(const Grid&, double);                            \
  template Nodes<Dim> regular_nodes<Dim>(const Box<Dim>&, const std::array<Index, Dim>&); \
  template double fill_distance<Dim>(const Nodes<Dim>&, const PointsRef<Dim>&);
CSRBF_INSTANTIATE(2)
CSRBF_INSTANTIATE(3)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
