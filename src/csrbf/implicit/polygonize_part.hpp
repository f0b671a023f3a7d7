#pragma once

#include "csrbf/implicit/polygonize.hpp"
#include "csrbf/implicit/polygonize/extraction.hpp"

namespace csrbf {

/// The triangles of a mesh that belong to a range of cells.
struct MeshPart {
  Mesh mesh;
  std::vector<polygonization::SharedVertex> shared;  ///< vertices that other parts may have, ascending
  std::vector<polygonization::Cell> border;  ///< crossed cells of the range that touch others, as far as it was traced
  std::vector<polygonization::Cell> beyond;  ///< cells of other ranges that touch this one and are crossed
  Index weak_features = 0;                   ///< bridges cut and holes filled
};

/// One part of a mesh that is made in parts: those of ranges that fill the lattice fit together, once every cell in
/// `beyond` of one of them was in the `border` of another; where it was not, make that part again with the cell among
/// its `starts`. The surface is followed from the seeds of the field in the range and from `starts`; there may be none.
/// Options: method (marching cubes or dual contouring), level, persistence, refine, normals, progress. Throws
/// InvalidInput for other methods; SolverFailure and Cancelled as polygonize(). Weak features are removed where they
/// are three cells from others.
MeshPart polygonize_part(const Field<3>& field, const polygonization::CellLattice& lattice,
                         const polygonization::CellRange& range, const std::vector<polygonization::Cell>& starts,
                         const PolygonizeOptions& options);

}  // namespace csrbf
