#pragma once

#include "csrbf/core/mesh.hpp"

namespace csrbf {

/// The part of a mesh where a function given at the vertices is not negative. Triangles that it changes its sign in are
/// cut where its linear interpolant is zero, at least a twentieth of an edge from the ends; normals and properties are
/// interpolated. Vertices keep their order, new ones follow in the order of the triangles. O(t). Throws InvalidInput
/// unless there is one value per vertex.
Mesh clip_mesh(const Mesh& mesh, const Eigen::VectorXd& value);

}  // namespace csrbf
