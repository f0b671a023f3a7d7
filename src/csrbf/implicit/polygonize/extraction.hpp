#pragma once

#include "csrbf/implicit/polygonize.hpp"
#include "csrbf/implicit/polygonize/cell_tracer.hpp"
#include "csrbf/implicit/polygonize/level_sampler.hpp"

namespace csrbf::polygonization {

/// What becomes a mesh: the cells that a tracer has visited.
struct Extraction {
  const CellLattice& lattice;
  LevelSampler& sampler;
  CellTracer& tracer;
  const PolygonizeOptions& options;
  double tolerance;  ///< a length
};

/// A vertex of a part of a mesh that other parts may have too. Equal keys are the same vertex.
struct SharedVertex {
  std::int32_t vertex;
  std::int64_t key;
};

/// Fills the mesh by the method of the options; returns the number of vertices that are not on edges.
Index extract(const Extraction& extraction, Mesh& mesh);

/// The part of the mesh that belongs to a range of cells, by marching cubes or dual contouring. The tracer has visited
/// the range and, for dual contouring, the layer of cells below it along each axis. Each triangle belongs to one range,
/// and vertices that several ranges have are the same bits in all of them. Returns the vertices that others may have.
std::vector<SharedVertex> extract_part(const Extraction& extraction, const CellRange& range, Mesh& mesh);

/// Drops the vertices without triangles; `shared` follows.
void drop_unused_vertices(Mesh& mesh, std::vector<SharedVertex>& shared);

}  // namespace csrbf::polygonization
