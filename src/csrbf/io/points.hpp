#pragma once

#include "csrbf/core/mesh.hpp"

#include <string>

namespace csrbf {

/// Which points of a scanner to keep.
struct PointSelection {
  std::vector<int> classes = {};  ///< by the property classification (ASPRS: 2 is ground, 6 building); empty: all
  std::string returns = "all";    ///< all, first, last or only, by return_number and number_of_returns

  [[nodiscard]] bool is_all() const { return classes.empty() && returns == "all"; }
};

/// The points of that selection, in their order, with their normals and properties. Throws InvalidInput when the cloud
/// lacks the properties or no point is left.
PointCloud select_points(const PointCloud& cloud, const PointSelection& selection);

/// Reads points from a file; its extension determines the format:
/// - .ply: ascii or binary; normals and every other scalar vertex property are kept.
/// - .xyz .pts .txt .csv, and "-" for standard input: rows of numbers separated by blanks, tabs, commas or semicolons;
///   # and // begin comments; .pts may begin with the number of rows. A first line without numbers (or a comment right
///   before the first row) names the columns: x y z nx ny nz red green blue and anything else. Without names the first
///   three columns are coordinates; three more are normals, or colours when they are whole numbers up to 255.
/// - .obj (v, vn, colours), .off (vertices), .vtp (points with their arrays): faces are ignored.
/// - .stl: its corners.
/// - .npy: an (n, 3) array of coordinates or (n, 6) with normals.
/// - .las, and .laz and .e57 when the library for them was found at build: all numbers of their points.
/// - .pcd of PCL; .ptx, with the scans in their common place.
/// Without an extension, the first bytes tell. Non-finite coordinates are kept. Throws IoError with the file and the
/// position in it.
PointCloud read_points(const std::string& path);

/// As read_points(), from the bytes of a file of that extension; `name` is for messages.
PointCloud parse_points(const std::string& extension, const std::string& bytes, const std::string& name);

/// Writes points in the format of the extension, complete or not at all (AtomicFile). .ply: binary, float coordinates
/// (double where float would move one by more than a millionth of the diagonal) and normals, properties of their own
/// type; .vtp: the same; .csv and .txt: everything under column names; .xyz .pts,
/// and "-" for standard output: coordinates and normals; .obj .off: coordinates, normals, colours; .npy: (n, 3) or (n,
/// 6) doubles. Returns a warning where properties were left out. Throws IoError.
std::vector<std::string> write_points(const std::string& path, const PointCloud& cloud);

/// The extensions that read_points() reads, separated by blanks.
const std::string& readable_point_formats();

/// True for the extension of a point file that write_points() writes.
bool is_point_file(const std::string& path);

/// True for the extension of one that read_points() reads.
bool is_readable_point_file(const std::string& path);

}  // namespace csrbf
