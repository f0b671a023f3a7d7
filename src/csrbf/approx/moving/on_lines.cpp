#include "csrbf/approx/moving/on_lines.hpp"

#include "csrbf/core/small_matrices.hpp"
#include "csrbf/spatial/chosen_points.hpp"
#include "csrbf/spatial/kd_tree.hpp"
#include "csrbf/spatial/morton_order.hpp"
#include "csrbf/spatial/usual_extent.hpp"

#include <algorithm>
#include <vector>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr Index looked_at = 400;  // points
constexpr Index neighbors = 16;
constexpr double flat = 0.1;  // second largest over largest variance of neighbours on a line
constexpr double many = 0.3;  // share of such neighbourhoods

template <int Dim>
double share_on_lines(const Points<Dim>& given) {
  const std::vector<Index> order = morton_order<Dim>(given);
  const Points<Dim> points = chosen_points<Dim>(given, order);
  const KdTree<Dim> tree(points);
  const Index n = points.cols(), count = std::min(looked_at, n);
  std::vector<Index> found(neighbors);
  std::vector<double> r2(neighbors);
  Index lines = 0;
  for (Index k = 0; k < count; ++k) {
    tree.nearest(points.col((2 * k + 1) * n / (2 * count)), neighbors, found.data(), r2.data());
    Points<Dim> x = points(Eigen::all, found);
    x.colwise() -= x.rowwise().mean().eval();
    const Eigen::Matrix<double, Dim, Dim> scatter = x * x.transpose();
    const Point<Dim> variances = symmetric_eigen(scatter).values;
    if (variances[Dim - 2] < flat * variances[Dim - 1]) ++lines;
  }
  return static_cast<double>(lines) / static_cast<double>(count);
}

}  // namespace

template <int Dim>
bool on_lines(const PointsRef<Dim>& points) {
  if constexpr (Dim == 1) {
    return false;
  } else {
    if (points.cols() < 4 * neighbors) return false;
    Point<Dim> extent = usual_extent<Dim>(points);
    const double longest = extent.maxCoeff();
    if (!(longest > 0)) return false;
    for (double& side : extent) side = side > 0 ? side : longest;
    if (longest < different_units * extent.minCoeff() && share_on_lines<Dim>(points) > many) return true;
    return share_on_lines<Dim>(extent.cwiseInverse().asDiagonal() * points) > many;
  }
}

#define CSRBF_INSTANTIATE(Dim) template bool on_lines<Dim>(const PointsRef<Dim>&);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
