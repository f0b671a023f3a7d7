#pragma once

#include "csrbf/core/mesh.hpp"
#include "csrbf/io/vtk/vtk.hpp"

namespace csrbf {

/// Reads a VTK image (.vti): the point array declared as its scalars, else the first one; without any, the cell arrays,
/// as voxels around the centres of the cells. Positions are taken as they are, in no patient space.
/// Throws IoError.
RawVolume parse_vti(std::string bytes, const std::string& path);

/// A VTK image whose points are the voxels, with one array `values`. Positions are written as they are.
FileParts format_vti(const VolumeLayout& layout, std::string samples);

/// The same with several arrays, whose bytes are in the order of the voxels. The first is the active one.
FileParts format_vti(const Grid& grid, std::vector<VtkArray> arrays);

/// Writes several named arrays over a grid to .vti, complete or not at all (AtomicFile). Throws IoError; InvalidInput
/// when there is no array or one does not match the grid.
void write_vti(const std::string& path, const Grid& grid, std::vector<VtkArray> arrays);

/// Reads VTK polygonal data (.vtp): points, polygons (as fans of triangles) and triangle strips; vertices and lines are
/// skipped. Point arrays become properties: Normals the normals, colours red, green and blue, vectors NAMEx, NAMEy and
/// NAMEz. Throws IoError with `name`.
Mesh parse_vtp(std::string_view bytes, const std::string& name);

/// The same of the lines, with the properties of their points but normals.
Polylines parse_vtp_polylines(std::string_view bytes, const std::string& name);

/// Are there lines, and neither polygons nor strips? Throws IoError for bytes that are no .vtp.
bool is_vtp_of_polylines(std::string_view bytes);

/// Points, triangles and properties as VTK polygonal data; without triangles the points are vertices. float
/// coordinates (double where float would move one by more than a millionth of the diagonal) and normals (Normals),
/// colours as RGB, properties of their own type; three named NAMEx, NAMEy and NAMEz become the vectors NAME.
std::string format_vtp(const Mesh& mesh);

/// The same for curves: an element of Lines for each edge.
std::string format_vtp(const Polylines& lines);

}  // namespace csrbf
