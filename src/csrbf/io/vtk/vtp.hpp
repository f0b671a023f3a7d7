#pragma once

#include "csrbf/core/mesh.hpp"

#include <string>
#include <string_view>

namespace csrbf {

/// Reads VTK polygonal data (.vtp): points, polygons (as fans of triangles) and triangle strips; vertices and lines are
/// skipped. Point arrays become properties: Normals the normals, colours red, green and blue, vectors NAMEx, NAMEy and
/// NAMEz. Throws IoError with `name`.
Mesh parse_vtp(std::string_view bytes, const std::string& name);

/// Points, triangles and properties as VTK polygonal data; without triangles the points are vertices. float
/// coordinates (double where float would move one by more than a millionth of the diagonal) and normals (Normals),
/// colours as RGB, properties of their own type; three named NAMEx, NAMEy and NAMEz become the vectors NAME.
std::string format_vtp(const Mesh& mesh);

/// The same for curves: an element of Lines for each edge.
std::string format_vtp(const Polylines& lines);

}  // namespace csrbf
