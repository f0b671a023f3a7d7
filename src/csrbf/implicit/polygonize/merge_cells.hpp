#pragma once

#include "csrbf/core/progress.hpp"
#include "csrbf/implicit/polygonize/dual_vertices.hpp"

namespace csrbf::polygonization {

/// Adapts cells to the curvature: cells become the leaves of an octree, and vertices joined by an edge within one of
/// its cubes become one where a quarter of `tolerance` bounds the root mean square distance of the merged vertex from
/// the planes of both, from the smallest cubes to the largest: the mesh then stays within about `tolerance` of the
/// surface. As edges of a closed mesh are collapsed, there is nothing that could crack; the topology stays. `planes`
/// belong to the vertices of the mesh.
void merge_cells(const CellLattice& lattice, double tolerance, std::vector<CellPlanes> planes, Mesh& mesh,
                 const Progress& progress);

}  // namespace csrbf::polygonization
