#pragma once

#include "csrbf/core/mesh.hpp"

#include <string>

namespace csrbf {

/// Writes curves to a binary .ply file, complete or not at all (AtomicFile): vertices with their properties, and edges.
/// Throws IoError, also for other extensions.
void write_polylines(const std::string& path, const Polylines& lines);

/// True when the extension is one of a file of curves.
bool is_polylines_file(const std::string& path);

}  // namespace csrbf
