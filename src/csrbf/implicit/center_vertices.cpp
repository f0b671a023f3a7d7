#include "csrbf/implicit/center_vertices.hpp"

#include "csrbf/implicit/edge_vertices.hpp"

namespace csrbf::polygonization {
namespace {

constexpr int newton_steps = 3;
constexpr double range = 0.25;  // of the shortest side of a cell

}  // namespace

void place_center_vertices(const CellLattice& lattice, LevelSampler& sampler, Index first, bool refine, Mesh& mesh) {
  const Index n = mesh.vertices.cols() - first;
  if (n == 0) return;
  const Points<3> start = mesh.vertices.rightCols(n);
  Points<3> points = start;
  const double longest = range * lattice.spacing.minCoeff();
  Jet<3> jet = sampler.jet(points);
  for (int step = 0; refine && step < newton_steps; ++step) {
    for (Index i = 0; i < n; ++i) {
      const Point<3> gradient = jet.gradient.col(i);
      const double slope = gradient.norm();
      const Point<3> shift = points.col(i) - jet.value[i] / slope * (gradient / slope) - start.col(i);
      if (shift.allFinite()) points.col(i) = start.col(i) + std::min(1.0, longest / shift.norm()) * shift;
    }
    jet = sampler.jet(points);
  }
  mesh.vertices.rightCols(n) = points;
  for (Index i = 0; i < mesh.normals.cols() - first; ++i)
    mesh.normals.col(first + i) = outward_normal(jet.gradient.col(i));
}

}  // namespace csrbf::polygonization
