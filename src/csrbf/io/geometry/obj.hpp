#pragma once

#include "csrbf/core/mesh.hpp"

#include <string>
#include <string_view>

namespace csrbf {

/// Reads a Wavefront OBJ text: v (with colours in [0, 1] after the coordinates, which become the properties red green
/// blue), vn when there are as many as vertices and every face pairs them by index, f (polygons become fans of
/// triangles; negative indices count from the end). Other lines are ignored. Throws IoError "name:line: ...".
Mesh parse_obj(std::string_view text, const std::string& name);

/// The same for curves: l (lines over two or more vertices); faces are skipped.
Polylines parse_obj_polylines(std::string_view text, const std::string& name);

/// Does the text have lines but no faces?
bool is_obj_of_polylines(std::string_view text);

/// Vertices, colours, normals and triangles as OBJ text; the format holds no other properties.
std::string format_obj(const Mesh& mesh);

}  // namespace csrbf
