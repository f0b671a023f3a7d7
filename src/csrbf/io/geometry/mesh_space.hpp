#pragma once

#include "csrbf/core/types.hpp"

#include <string>
#include <string_view>

namespace csrbf {

/// The bytes of a mesh file that also say in which patient space its coordinates are, as 3D Slicer does: SPACE=RAS or
/// SPACE=LPS in a comment of .ply and .obj and in the header of .stl, field data SPACE of .vtp. Slicer takes meshes
/// without for LPS. An unknown space, and other extensions: the bytes as they are.
std::string with_space(std::string bytes, std::string_view extension, Space space);

/// The space that the bytes of a mesh file say, in the same places.
Space space_in(std::string_view bytes, std::string_view extension);

}  // namespace csrbf
