#pragma once

#include "csrbf/implicit/polygonize/dual_vertices.hpp"

namespace csrbf::polygonization {

/// Draws loose vertices of triangles that are folded over back to the mean of the crossings around them: half of the
/// way, and after the last of a few rounds all of it. Tips, where planes do meet, stay. Normals of the mesh are those
/// of the dual surface.
void unfold_quads(const DualSurface& surface, const Mesh& crossings, Mesh& mesh);

/// Cuts the quads of a dual surface into triangles of the mesh, whose vertices are in place: along the diagonal that
/// folds no triangle over and comes closest to the crossing of the quad's edge, which lies on the surface; of diagonals
/// that are as good, the shorter. Triangles 2 e and 2 e + 1 come from quad e; those of quads with vertices on their
/// sides that exceed two follow at the end.
void triangulate_quads(const DualSurface& surface, const Mesh& crossings, Mesh& mesh);

}  // namespace csrbf::polygonization
