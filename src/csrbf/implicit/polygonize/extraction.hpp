#pragma once

#include "csrbf/core/mesh.hpp"
#include "csrbf/implicit/polygonize/cell_tracer.hpp"
#include "csrbf/implicit/polygonize/level_sampler.hpp"

namespace csrbf::polygonization {

/// What becomes a mesh: the cells that a tracer has visited.
struct Extraction {
  const CellLattice& lattice;
  LevelSampler& sampler;
  CellTracer& tracer;
  bool refine;   ///< vertices on the surface, not only on chords
  bool normals;  ///< also at the vertices
  const Progress& progress;
};

/// A vertex of a part of a mesh that other parts may have too. Equal keys are the same vertex.
struct SharedVertex {
  std::int32_t vertex;
  std::int64_t key;
};

// Each fills the mesh and returns the number of vertices that are not on edges, or, by dual contouring, not in cells.

Index marching_cubes(const Extraction& extraction, Mesh& mesh);
Index marching_tetrahedra(const Extraction& extraction, Mesh& mesh);
Index dual_contouring(const Extraction& extraction, Mesh& mesh);
/// Dual contouring on an octree: cells are merged where the surface is flat up to `tolerance`, a length.
Index adaptive_contouring(const Extraction& extraction, double tolerance, Mesh& mesh);

// Each fills the part of the mesh that belongs to a range of cells. The tracer has visited the range and, for dual
// contouring, the layer of cells below it along each axis. Each triangle belongs to one range, and vertices that
// several ranges have are the same bits in all of them. Returns the vertices that others may have.

std::vector<SharedVertex> marching_cubes_part(const Extraction& extraction, const CellRange& range, Mesh& mesh);
std::vector<SharedVertex> dual_contouring_part(const Extraction& extraction, const CellRange& range, Mesh& mesh);

/// Drops the vertices without triangles; `shared` follows.
void drop_unused_vertices(Mesh& mesh, std::vector<SharedVertex>& shared);

}  // namespace csrbf::polygonization
