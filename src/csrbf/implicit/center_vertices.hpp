#pragma once

#include "csrbf/core/mesh.hpp"
#include "csrbf/implicit/brick_grid.hpp"
#include "csrbf/implicit/level_sampler.hpp"

namespace csrbf::polygonization {

/// Moves the vertices from `first` on towards the surface, by three Newton steps along the gradient and at most a
/// quarter of a cell, when `refine` says so; fills their normals when the mesh has normals.
void place_center_vertices(const CellLattice& lattice, LevelSampler& sampler, Index first, bool refine, Mesh& mesh);

}  // namespace csrbf::polygonization
