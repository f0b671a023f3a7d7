#pragma once

#include "csrbf/core/mesh.hpp"
#include "csrbf/implicit/polygonize/brick_grid.hpp"

namespace csrbf::polygonization {

/// Triangles of marching tetrahedra: every cell is divided into the six tetrahedra around its diagonal from corner 0 to
/// corner 7, whose faces match those of the neighbours. Edge vertices in all directions must be numbered and in place.
/// Triangles follow the order of bricks, cells and tetrahedra.
void march_tetrahedra(const std::vector<Brick*>& bricks, Mesh& mesh);

}  // namespace csrbf::polygonization
