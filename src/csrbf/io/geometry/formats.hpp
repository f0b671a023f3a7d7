#pragma once

#include "csrbf/core/mesh.hpp"

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

/// Reads an OFF text (OFF, NOFF with normals, COFF with colours, STOFF with texture coordinates, which are skipped, and
/// their combinations). Polygons become fans of triangles. Throws IoError "name:line: ...".
Mesh parse_off(std::string_view text, const std::string& name);

/// Vertices, normals, colours and triangles as OFF text; the format holds no other properties.
std::string format_off(const Mesh& mesh);

/// Reads the bytes of a PLY file: ascii or binary of either byte order, every scalar type. Vertex properties x y z
/// become the vertices, nx ny nz (when all three are there) the normals, the other scalars properties of their type.
/// Polygons become fans of triangles; a point file gives a mesh without triangles. List properties of vertices and
/// other elements are skipped. Throws IoError "name:line: ..." (text) or "name: vertex 17: ..." (binary).
Mesh parse_ply(std::string_view bytes, const std::string& name);

/// The same for curves: edges are elements "edge" with the properties vertex1 and vertex2; faces are skipped.
Polylines parse_ply_polylines(std::string_view bytes, const std::string& name);

/// Does the file have edges but no faces? False for bytes that are not a PLY file.
bool is_ply_of_polylines(std::string_view bytes);

/// The bytes of a binary little-endian PLY file: float coordinates, or double where float would move one by more than
/// a millionth of the diagonal (float_coordinate_loss()), float normals, properties of their own type, and faces unless
/// `mesh` has no triangles. Throws InvalidInput when normals or properties do not have one entry per vertex.
std::string format_ply(const Mesh& mesh);

/// The same for curves: an element "edge" with the properties vertex1 and vertex2.
std::string format_ply(const Polylines& lines);

/// Layouts of points in text: .xyz rows only, .pts with the number of rows first, .txt with names in a comment, .csv
/// with names and commas.
enum class TableStyle { xyz, pts, txt, csv };

/// Reads points from rows of numbers; read_points() documents how columns are interpreted. Throws IoError.
PointCloud parse_point_table(std::string_view text, const std::string& name);

/// Points as text; .xyz and .pts keep coordinates and normals only.
std::string format_point_table(const PointCloud& cloud, TableStyle style);

/// Reads a LAS file, versions 1.0 to 1.4, all point formats: coordinates with all their digits, and the properties
/// intensity, return_number, number_of_returns, classification, point_source_id, gps_time and red green blue where the
/// format has them. Points marked as withheld are left out. Throws IoError, for compressed files (LAZ) too.
PointCloud parse_las(std::string_view bytes, const std::string& name);

/// Reads a LAZ file, COPC among them, by laz-perf or LASzip, with the result of parse_las(). Throws IoError, in builds
/// without either always, with what to do.
PointCloud parse_laz(std::string_view bytes, const std::string& name);
/// Is there one of the libraries?
bool reads_laz();

/// Reads all scans of an E57 file, in their common coordinates, by libE57Format: valid points, the property intensity
/// and red green blue. Throws IoError, in builds without it always, with what to do.
PointCloud parse_e57(std::string_view bytes, const std::string& name);
/// Is the library there?
bool reads_e57();

/// Reads a PTX text: one scan or more, each in the place that its matrix says; the properties intensity and, when all
/// points have them, red green blue. Points at 0 0 0 of the scanner, which had no return, are left out. Throws IoError
/// "name:line: ...".
PointCloud parse_ptx(std::string_view text, const std::string& name);

/// Reads a PCD file of PCL: text, binary or compressed; normals (normal_x ...), colours (rgb or rgba) and every other
/// field of one number. The viewpoint is not applied. Throws IoError.
PointCloud parse_pcd(std::string_view bytes, const std::string& name);

/// The bytes of a binary glTF 2.0 file: vertices, normals, colours and triangles, or points when there are none. Where
/// float32 would lose digits of the coordinates, they are relative to the middle, to which the node moves them.
std::string format_glb(const Mesh& mesh);

/// The bytes of a 3MF package for printers, in mm: vertices, triangles and the colours of vertices; the format has no
/// normals. Where float32 would lose digits of the coordinates, they are relative to the middle, to which the item
/// moves them. Throws InvalidInput without triangles.
std::string format_3mf(const Mesh& mesh);

/// Reads a binary or text STL file. Corners with identical coordinates are merged into one vertex; vertices are
/// numbered in the order of their first use. Throws IoError.
Mesh parse_stl(std::string_view bytes, const std::string& name);

/// The bytes of a binary STL file: float coordinates and the normals of the triangles. Coordinates far from the origin
/// lose precision: see float_coordinate_loss().
std::string format_stl(const Mesh& mesh);

}  // namespace csrbf
