#pragma once

#include "csrbf/core/mesh.hpp"

#include <string>
#include <string_view>

namespace csrbf {

/// Reads a binary or text STL file. Corners with identical coordinates are merged into one vertex; vertices are
/// numbered in the order of their first use. Throws IoError.
Mesh parse_stl(std::string_view bytes, const std::string& name);

/// The bytes of a binary STL file: float coordinates and the normals of the triangles. Coordinates far from the origin
/// lose precision: see float_coordinate_loss().
std::string format_stl(const Mesh& mesh);

}  // namespace csrbf
