#pragma once

#include "csrbf/core/mesh.hpp"
#include "csrbf/implicit/polygonize/brick_grid.hpp"

namespace csrbf::polygonization {

/// Number of triangles and centre vertices before each brick.
struct TriangleOffsets {
  std::vector<Index> triangles;  ///< bricks + 1
  std::vector<Index> centers;    ///< bricks + 1
};

/// Counts the triangles of every brick, and the loops that need a vertex inside their cell.
TriangleOffsets count_triangles(const std::vector<Brick*>& bricks);

/// Fills the triangles of the mesh, whose edge vertices are in place, in the order of bricks and cells. Loops that are
/// not triangulable get a vertex at the mean of their vertices; these follow `edge_vertices` in the same order.
void fill_triangles(const std::vector<Brick*>& bricks, const TriangleOffsets& offsets, Index edge_vertices, Mesh& mesh);

}  // namespace csrbf::polygonization
