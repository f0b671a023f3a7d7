#pragma once

#include "csrbf/core/mesh.hpp"

#include <string>
#include <variant>

namespace csrbf {

/// Reads curves from a file; its extension determines the format:
/// - .csv .txt .xyz .pts, and "-" for standard input: rows of numbers as read by read_points(), under column names: x y
///   z, and `contour` (or else `slice`), a number that the points of one curve share. Points are in order along the
///   curve, and the last one is joined to the first unless a column `closed` is 0.
/// - .obj: lines (l); a line that ends where it began is closed.
/// - .ply: an element edge with vertex1 and vertex2, as written by write_polylines().
///
/// Throws IoError with the file and the position in it, also for files without a curve.
Polylines read_polylines(const std::string& path);

/// Reads curves if the file has them: a column `contour`, or lines (edges) and no faces. Otherwise, and always from
/// standard input, reads points as read_points() does, with the faces of a mesh. The file is read once and may be a
/// pipe. Throws IoError.
std::variant<Mesh, Polylines> read_points_or_polylines(const std::string& path);

/// Writes curves to a binary .ply or a .vtp file, completely or not at all: vertices with their properties, and edges.
/// Throws IoError, also for other extensions.
void write_polylines(const std::string& path, const Polylines& lines);

/// Whether write_polylines() writes files with this extension.
bool is_polylines_file(const std::string& path);

}  // namespace csrbf
