#pragma once

#include "csrbf/implicit/polygonize/dual_vertices.hpp"

namespace csrbf::polygonization {

/// Moves loose vertices of folded triangles towards the mean of the crossings around them: halfway, and in the last of
/// a few rounds all the way. Tips, where planes do meet, do not move. Normals of the mesh are those of the dual
/// surface.
void unfold_quads(const DualSurface& surface, const Mesh& crossings, Mesh& mesh);

/// Splits the quads of a dual surface into triangles of the mesh, whose vertices are in place: along the diagonal that
/// folds no triangle and comes closest to the crossing of the quad's edge, which lies on the surface; among equally
/// good diagonals, the shorter. Triangles 2 e and 2 e + 1 come from quad e; further ones, of quads with vertices on
/// their sides, follow at the end.
void triangulate_quads(const DualSurface& surface, const Mesh& crossings, Mesh& mesh);

}  // namespace csrbf::polygonization
