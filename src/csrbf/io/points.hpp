#pragma once

#include "csrbf/core/mesh.hpp"

#include <string>

namespace csrbf {

/// Which points of a laser scan to keep.
struct PointSelection {
  std::vector<int> classes = {};  ///< by the property classification (ASPRS: 2 is ground, 6 building); empty: all
  std::string returns = "all";    ///< all, first, last or only, by return_number and number_of_returns

  [[nodiscard]] bool is_all() const { return classes.empty() && returns == "all"; }
};

/// The selected points in their order, with their normals and properties. Throws InvalidInput if the cloud lacks the
/// properties or no point is left.
PointCloud select_points(const PointCloud& cloud, const PointSelection& selection);

/// Reads points from a file; its extension determines the format:
/// - .ply: ascii or binary; normals and every other scalar vertex property are kept.
/// - .xyz .pts .txt .csv, and "-" for standard input: rows of numbers separated by blanks, tabs, commas or semicolons;
///   comments begin with # or //; .pts may begin with the number of rows. A first line without numbers, or a comment
///   right before the first row, names the columns: x y z nx ny nz red green blue and anything else. Without names the
///   first three columns are coordinates; three more are normals, or colours if they are whole numbers up to 255.
/// - .obj (v, vn, colours), .off (vertices), .vtp (points with their arrays): faces are ignored.
/// - .stl: its corners.
/// - .npy: an (n, 3) array of coordinates or (n, 6) with normals.
/// - .las, and .laz and .e57 if the library was built with support for them: all numbers of their points.
/// - .pcd of PCL; .ptx, with all scans in their common coordinates.
///
/// Without an extension, the first bytes decide. Coordinates that are not finite are kept. Throws IoError with the file
/// and the position in it.
PointCloud read_points(const std::string& path);

/// As read_points(), from the bytes of a file with this extension; `name` appears in messages.
PointCloud parse_points(const std::string& extension, const std::string& bytes, const std::string& name);

/// Writes points in the format of the extension, completely or not at all:
/// - .ply: binary; float coordinates, double if float would move one by more than a millionth of the diagonal; float
///   normals; properties of their own type.
/// - .vtp: the same.
/// - .csv, .txt: everything, under column names.
/// - .xyz, .pts, and "-" for standard output: coordinates and normals.
/// - .obj, .off: coordinates, normals and colours.
/// - .npy: (n, 3) or (n, 6) doubles.
///
/// Returns a warning if properties were left out. Throws IoError.
std::vector<std::string> write_points(const std::string& path, const PointCloud& cloud);

/// The extensions that read_points() reads, separated by blanks.
const std::string& readable_point_formats();

/// Whether write_points() writes files with this extension.
bool is_point_file(const std::string& path);

/// Whether read_points() reads files with this extension.
bool is_readable_point_file(const std::string& path);

}  // namespace csrbf
