#pragma once

#include "csrbf/core/mesh.hpp"

#include <string>
#include <string_view>

namespace csrbf {

/// Reads an OFF text (OFF, NOFF with normals, COFF with colours, STOFF with texture coordinates, which are skipped, and
/// their combinations). Polygons become fans of triangles. Throws IoError "name:line: ...".
Mesh parse_off(std::string_view text, const std::string& name);

/// Vertices, normals, colours and triangles as OFF text; the format holds no other properties.
std::string format_off(const Mesh& mesh);

}  // namespace csrbf
