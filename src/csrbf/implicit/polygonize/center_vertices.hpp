#pragma once

#include "csrbf/core/mesh.hpp"
#include "csrbf/implicit/polygonize/brick_grid.hpp"
#include "csrbf/implicit/polygonize/level_sampler.hpp"

namespace csrbf::polygonization {

/// Moves the vertices from `first` on to the surface when `refine` says so: by at most three Newton steps along the
/// gradient that each bring |f| down, and at most a quarter of a cell. Fills their normals when the mesh has normals:
/// from the gradient, unless that is far off the normal they have, the mean over an edge or a tip, or not defined.
/// Vertices beyond the corners that were sampled, on caps, stay as they are.
void place_center_vertices(const CellLattice& lattice, LevelSampler& sampler, Index first, bool refine, Mesh& mesh);

}  // namespace csrbf::polygonization
