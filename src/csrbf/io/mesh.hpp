#pragma once

#include "csrbf/core/mesh.hpp"

#include <string>

namespace csrbf {

/// Reads a triangle mesh from .ply, .obj, .off, .stl or .vtp; the extension decides. Polygons become fans of triangles,
/// indices are checked, and equal corners in .stl files are merged into one vertex. Files that state SPACE=RAS or LPS,
/// as those of 3D Slicer do, set Mesh::space. Throws IoError, also if there are no faces.
Mesh read_mesh(const std::string& path);

/// As read_mesh(), for any mesh or point file: a file without faces gives a mesh without triangles.
Mesh read_mesh_or_points(const std::string& path);

/// As read_mesh_or_points(), from the bytes of a file with this extension; `name` appears in messages.
Mesh parse_mesh_or_points(const std::string& extension, const std::string& bytes, const std::string& name);

/// Writes a mesh in the format of the extension, completely or not at all:
/// - .ply: binary; float coordinates, double if float would move one by more than a millionth of the diagonal; float
///   normals; properties of their own type.
/// - .vtp for VTK and ParaView: the same.
/// - .obj, .off: with normals and colours. "-" writes .off text to standard output.
/// - .stl: binary, always float.
/// - .glb, .3mf.
///
/// A mesh in patient coordinates says so for 3D Slicer, except in .off, .glb and .3mf. Returns warnings, such as a loss
/// of precision in .stl. Throws IoError.
std::vector<std::string> write_mesh(const std::string& path, const Mesh& mesh);

/// Whether the extension is that of a mesh file.
bool is_mesh_file(const std::string& path);

}  // namespace csrbf
