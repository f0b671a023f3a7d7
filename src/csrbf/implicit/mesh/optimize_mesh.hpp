#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/core/mesh.hpp"
#include "csrbf/core/progress.hpp"

namespace csrbf {

struct OptimizeMeshOptions {
  int iterations = 10;  ///< at least 1
  double level = 0;     ///< the mesh is of the surface f = level
  Progress progress{};  ///< stage "optimize"
};

/// Makes the triangles of a closed polygonization rounder, by two alternating steps. Every vertex moves along the
/// surface towards the mean of its neighbours if that raises the least roundness (area over the square of the longest
/// side) of its triangles: smart Laplacian smoothing, Freitag 1997. Then all vertices move onto the surface by a Newton
/// step along the gradient. Connectivity does not change, and vertices on sharp edges do not move: those with triangles
/// tilted by more than 45 degrees against the normal. Normals are updated if the mesh has any. O(iterations (vertices +
/// triangles)), plus one gradient per vertex and iteration.
///
/// Throws InvalidInput for a mesh that is not closed and manifold or has vertices that are not finite, and for options
/// out of range; Cancelled.
Mesh optimize_mesh(const Field<3>& field, Mesh mesh, const OptimizeMeshOptions& options = {});

/// The smallest angle of any triangle of a mesh, in degrees; 0 if corners coincide.
double smallest_angle(const Mesh& mesh);

}  // namespace csrbf
