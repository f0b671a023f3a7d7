#pragma once

#include "csrbf/core/mesh.hpp"
#include "csrbf/core/progress.hpp"
#include "csrbf/implicit/polygonize/brick_grid.hpp"
#include "csrbf/implicit/polygonize/level_sampler.hpp"

#include <bit>

namespace csrbf::polygonization {

/// What is required of the vertices.
struct VertexDemand {
  bool refine = true;   ///< on the surface, not only on the chord of the two corner values
  bool normals = true;  ///< outward unit normals
};

/// -gradient / |gradient|; zero where undefined.
inline Point<3> outward_normal(const Point<3>& gradient) {
  const double slope = gradient.norm();
  return slope > 0 && std::isfinite(slope) ? Point<3>(-gradient / slope) : Point<3>::Zero();
}

/// Numbers the crossed edges of all bricks in order: within a brick by direction, then by lower corner. Returns their
/// number. Throws SolverFailure if a mesh cannot hold that many.
Index number_edge_vertices(const std::vector<Brick*>& bricks);

/// Number of the vertex on the edge in direction d from a corner.
inline int edge_vertex(const CornerRef& corner, int d) {
  const Mask before = corner.brick.edges[d] & ((Mask{1} << corner.bit) - 1);
  return corner.brick.vertex[d] + std::popcount(before);
}

/// Places every numbered vertex where the surface crosses its edge, and fills its normal if requested.
///
/// Starts from linear interpolation of the corner values. With refinement each evaluation narrows the bracket; the next
/// point is the root of the parabola through the value and slope there and the other end of the bracket, until that
/// root moves by less than 1e-4 of the edge, or differs by less than that from Newton's, at most 12 times. One
/// evaluation is enough for most vertices of a smooth field. Both roots may agree by chance where the curvature of the
/// field changes sign along the edge: then the error may be some hundredths of the edge. A root within `edge_margin` of
/// a corner is first clamped to that margin, then moved onto the surface along the gradient. A vertex of the cap that
/// closes the solid at the boundary lies `edge_margin` outside its inside corner.
void place_edge_vertices(const CellLattice& lattice, const std::vector<Brick*>& bricks, LevelSampler& sampler,
                         const VertexDemand& demand, Mesh& mesh, const Progress& progress);

}  // namespace csrbf::polygonization
