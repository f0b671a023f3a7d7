#pragma once

#include "csrbf/core/mesh.hpp"

#include <vector>

namespace csrbf {

/// Points of uniform density on the surface of a mesh.
struct SurfaceSamples {
  Points<3> points;                    ///< 3 x n
  Points<3> normals;                   ///< 3 x n, of the triangles by the right-hand rule
  std::vector<std::int32_t> triangle;  ///< n
};

/// Draws n points uniformly by area, stratified: sample i lies in the i-th of n equal parts of the area in triangle
/// order, so that neighbours in a coherent mesh are neighbours among the samples and averages converge faster than with
/// independent samples. Depends only on the mesh, n and seed. Throws InvalidInput if the mesh has no area.
/// O(t + n log t).
SurfaceSamples sample_surface(const Mesh& mesh, Index n, std::uint64_t seed = 7);

}  // namespace csrbf
