#pragma once

#include "csrbf/core/mesh.hpp"

#include <string>
#include <string_view>

namespace csrbf {

/// Reads the bytes of a PLY file: ascii or binary of either byte order, every scalar type. Vertex properties x y z
/// become the vertices, nx ny nz (when all three are there) the normals, the other scalars properties of their type.
/// Polygons become fans of triangles; a point file gives a mesh without triangles. List properties of vertices and
/// other elements are skipped. Throws IoError "name:line: ..." (text) or "name: vertex 17: ..." (binary).
Mesh parse_ply(std::string_view bytes, const std::string& name);

/// The same for curves: edges are elements "edge" with the properties vertex1 and vertex2; faces are skipped.
Polylines parse_ply_polylines(std::string_view bytes, const std::string& name);

/// Does the file have edges but no faces? False for bytes that are not a PLY file.
bool is_ply_of_polylines(std::string_view bytes);

/// The bytes of a binary little-endian PLY file: float coordinates, or double where float would move one by more than
/// a millionth of the diagonal (float_coordinate_loss()), float normals, properties of their own type, and faces unless
/// `mesh` has no triangles. Throws InvalidInput when normals or properties do not have one entry per vertex.
std::string format_ply(const Mesh& mesh);

/// The same for curves: an element "edge" with the properties vertex1 and vertex2.
std::string format_ply(const Polylines& lines);

}  // namespace csrbf
