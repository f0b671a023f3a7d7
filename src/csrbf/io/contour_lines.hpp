#pragma once

#include "csrbf/implicit/contour_lines.hpp"

#include <array>
#include <string>

namespace csrbf {

struct ContourFileOptions {
  /// For .csv, .ply and .vtp: maps (x, y, 0) in the plane to space.
  Eigen::Matrix<double, 3, 4> placement = Eigen::Matrix<double, 3, 4>::Identity();

  /// For .svg: the part of the plane to show. Default (an empty box): the bounding box of the points with a small
  /// margin.
  Box<2> view{};
};

/// Writes the lines of a contour, completely or not at all. The extension determines the format:
/// - .svg: a drawing in the coordinates of the plane, with y downwards as in images. One path has all closed lines,
///   filled by the even-odd rule so that holes stay empty; another one has the open lines, not filled. 9 digits.
/// - .csv: columns x, y, z, contour (the number of the line, from 0) and, if a line is open, closed (0 or 1). All
///   digits; read_polylines() reads it.
/// - .ply .vtp: curves as written by write_polylines(), with the vertex property `contour`.
///
/// Throws IoError, also for other extensions; InvalidInput if lines and points do not match or the view is not finite.
void write_contour_lines(const std::string& path, const ContourLines& contours, const ContourFileOptions& options = {});

/// Whether the extension is one of these.
bool is_contour_lines_file(const std::string& path);

struct LevelFileOptions {
  std::array<std::string, 2> coordinate_names{"x", "y"};  ///< columns of .csv
  std::string value_name = "value";                       ///< column of .csv, field of maps
  std::string crs = {};                                   ///< reference system, for maps
};

/// Writes contour lines of a map, completely or not at all. The extension determines the format:
/// - .csv: columns with the coordinates, the level, contour (the number of the line, from 0) and closed (0 or 1). All
///   digits.
/// - .ply .vtp: curves in space as written by write_polylines(), with the level as z and the vertex property `contour`.
/// - .gpkg .shp .geojson .fgb, lines on maps, by GDAL: one field with the level; closed lines end where they begin.
///
/// Throws IoError, also for other extensions.
void write_level_lines(const std::string& path, const std::vector<LevelLine>& lines,
                       const LevelFileOptions& options = {});

/// Whether the extension is one of these.
bool is_level_lines_file(const std::string& path);

}  // namespace csrbf
