#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/core/mesh.hpp"
#include "csrbf/core/progress.hpp"

namespace csrbf {

struct RidgeLineOptions {
  double level = 0;  ///< the surface f = level, whose mesh is given
  /// Lines whose |curvature|, integrated over their length, is less than this are left out (Ohtake, Belyaev, Seidel
  /// 2004). In radians, at least 0; independent of the scale of the surface.
  double least_turning = 2;
  Progress progress{};  ///< stage "ridges"
};

/// The crest lines of a surface (thesis 4.1.3). Ridges: k1 is largest along its own line of curvature, and k1 > |k2|.
/// Valleys: k2 is smallest along its own line of curvature, and k2 < -|k1| (the thesis prints the opposite sign for
/// that derivative). Replacing f by -f swaps them.
///
/// `mesh` is a polygonization of the surface f = level with its vertices on it. The lines cross mesh edges where the
/// derivative of the curvature changes sign; their points are then moved to its zero. So the accuracy is that of the
/// field and of differences over half an edge: O(edge^2). Coarser meshes give smoother lines. Lines end where both
/// curvatures are nearly equal, because the directions are undefined there.
///
/// Vertex properties: `kind` (char) is 1 on ridges and -1 on valleys; `curvature` (float) is k1 or k2. No two lines
/// share a vertex. About 8 Hessians for each vertex of the mesh and 40 for each vertex of the lines. Throws
/// InvalidInput if the mesh has no triangles or an option is out of range; Cancelled.
Polylines ridges(const Field<3>& field, const Mesh& mesh, const RidgeLineOptions& options = {});

}  // namespace csrbf
