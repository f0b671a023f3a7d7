#pragma once

#include "csrbf/core/mesh.hpp"

#include <string>
#include <variant>

namespace csrbf {

/// Reads curves from a file; its extension determines the format:
/// - .csv .txt .xyz .pts, and "-" for standard input: rows of numbers as read_points() reads them, under names of
///   columns: x y z, and `contour` (or, without it, `slice`), a number that the points of one closed curve share. Their
///   order in the file is that along the curve; the last point is joined to the first unless a column `closed` is 0
///   there.
/// - .obj: lines (l); a line that ends where it began is closed.
/// - .ply: an element edge with vertex1 and vertex2, as write_polylines() writes it.
/// Throws IoError with the file and the position in it; also for files without a curve.
Polylines read_polylines(const std::string& path);

/// Curves when the file holds them rather than points or a surface: a column `contour`, or lines (edges) and no faces;
/// otherwise points, as read_points() reads them, as always from standard input, with the faces of a mesh. The file is
/// read once and may be a pipe. Throws IoError.
std::variant<Mesh, Polylines> read_points_or_polylines(const std::string& path);

/// Writes curves to a binary .ply or .vtp file, complete or not at all (AtomicFile): vertices with their properties,
/// and edges. Throws IoError, also for other extensions.
void write_polylines(const std::string& path, const Polylines& lines);

/// True for an extension that write_polylines() supports.
bool is_polylines_file(const std::string& path);

}  // namespace csrbf
