#pragma once

#include "csrbf/core/mesh.hpp"
#include "csrbf/implicit/polygonize/brick_grid.hpp"
#include "csrbf/implicit/polygonize/level_sampler.hpp"

namespace csrbf::polygonization {

/// Moves the vertices from `first` on onto the surface if `refine`: by at most three Newton steps along the gradient,
/// each of which must reduce |f|, and at most a quarter of a cell. Fills their normals if the mesh has normals: from
/// the gradient, unless it is undefined or deviates far from their present normal, the mean over an edge or a tip.
/// Vertices beyond the corners that were sampled, on caps, do not move.
void place_center_vertices(const CellLattice& lattice, LevelSampler& sampler, Index first, bool refine, Mesh& mesh);

}  // namespace csrbf::polygonization
