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

/// Makes the triangles of a closed polygonization rounder. Alternately, every vertex moves along the surface towards
/// the mean of its neighbours if that raises the least roundness of its triangles, area over the square of the longest
/// side (smart Laplacian smoothing; Freitag 1997), and all vertices move onto the surface by a Newton step along the
/// gradient. Connectivity does not change. Vertices on sharp edges, with triangles tilted by more than 45 degrees
/// against the normal there, do not move. Fills the normals if the mesh has any. O(iterations (vertices + triangles)),
/// plus one gradient for each vertex and iteration.
///
/// Throws InvalidInput for a mesh that is not closed and manifold or has vertices that are not finite, and options
/// outside the above; Cancelled.
Mesh optimize_mesh(const Field<3>& field, Mesh mesh, const OptimizeMeshOptions& options = {});

/// The least angle of any triangle of a mesh, in degrees; 0 where corners coincide.
double smallest_angle(const Mesh& mesh);

}  // namespace csrbf
