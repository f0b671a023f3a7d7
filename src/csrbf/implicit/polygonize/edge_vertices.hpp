#pragma once

#include "csrbf/core/mesh.hpp"
#include "csrbf/core/progress.hpp"
#include "csrbf/implicit/polygonize/brick_grid.hpp"
#include "csrbf/implicit/polygonize/level_sampler.hpp"

#include <bit>

namespace csrbf::polygonization {

/// What is asked of the vertices.
struct VertexDemand {
  bool refine = true;   ///< on the surface, not only on the chord of the two corner values
  bool normals = true;  ///< outward unit normals
  bool sharp = false;   ///< normals at the vertices themselves, not at the estimates before: right next to edges
};

/// -gradient / |gradient|; zero where that is not defined.
inline Point<3> outward_normal(const Point<3>& gradient) {
  const double slope = gradient.norm();
  return slope > 0 && std::isfinite(slope) ? Point<3>(-gradient / slope) : Point<3>::Zero();
}

/// Numbers the crossed edges of all bricks in order: within a brick by direction, then by lower corner. Returns their
/// number. Throws SolverFailure when a mesh cannot hold that many.
Index number_edge_vertices(const std::vector<Brick*>& bricks);

/// Number of the vertex on the edge in direction d from a corner.
inline int edge_vertex(const CornerRef& corner, int d) {
  const Mask before = corner.brick.edges[d] & ((Mask{1} << corner.bit) - 1);
  return corner.brick.vertex[d] + std::popcount(before);
}

/// Places every numbered vertex where the surface crosses its edge, and fills its normal when asked.
///
/// Starts from linear interpolation of the corner values. With refinement each evaluation narrows the bracket; the next
/// point is the root of the parabola through the value and slope there and the other end of the bracket. One evaluation
/// is enough for most vertices of a smooth field: until that root moves by less than 1e-4 of the edge, or differs by
/// less than that from Newton's, at most 12. Both may agree by chance where the field bends the other way along the
/// edge: then the vertex may be off by some hundredths of it. A root within `edge_margin` of a corner is first held at
/// that margin, then moved onto the surface along the gradient. A vertex of the cap that closes the solid at the
/// boundary stands `edge_margin` outside its inside corner.
void place_edge_vertices(const CellLattice& lattice, const std::vector<Brick*>& bricks, LevelSampler& sampler,
                         const VertexDemand& demand, Mesh& mesh, const Progress& progress);

}  // namespace csrbf::polygonization
