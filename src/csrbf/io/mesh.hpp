#pragma once

#include "csrbf/core/mesh.hpp"

#include <string>

namespace csrbf {

/// Reads a triangle mesh from .ply, .obj, .off, .stl or .vtp (the extension decides); polygons become fans of
/// triangles, indices are checked, equal corners of .stl files are merged into one vertex. A file that says SPACE=RAS
/// or LPS, as those of 3D Slicer do, tells the space. Throws IoError, also when there are no faces.
Mesh read_mesh(const std::string& path);

/// As read_mesh, for any mesh or point file: a file without faces gives a mesh without triangles.
Mesh read_mesh_or_points(const std::string& path);

/// As read_mesh_or_points(), from the bytes of a file of that extension; `name` is for messages.
Mesh parse_mesh_or_points(const std::string& extension, const std::string& bytes, const std::string& name);

/// Writes a mesh in the format of the extension, complete or not at all (AtomicFile): binary .ply with float
/// coordinates (double where float would move one by more than a millionth of the diagonal), float normals and
/// properties of their own type; .vtp of VTK and ParaView with the same; .obj and .off with normals and colours; binary
/// .stl, always float. "-" writes .off text to standard output. A mesh in patient coordinates says so to 3D Slicer, but
/// for .off, .glb and .3mf. Returns warnings: a loss of precision in .stl. Throws IoError.
std::vector<std::string> write_mesh(const std::string& path, const Mesh& mesh);

/// True for the extension of a mesh file.
bool is_mesh_file(const std::string& path);

}  // namespace csrbf
