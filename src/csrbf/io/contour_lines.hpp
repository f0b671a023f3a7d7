#pragma once

#include "csrbf/implicit/contour_lines.hpp"

#include <string>

namespace csrbf {

struct ContourFileOptions {
  /// .csv, .ply and .vtp: map from (x, y, 0) in the plane to space.
  Eigen::Matrix<double, 3, 4> placement = Eigen::Matrix<double, 3, 4>::Identity();

  /// .svg: the part of the plane that the image shows. Default (an empty box): the box of the points with a small
  /// margin.
  Box<2> view{};
};

/// Writes the lines of a contour, complete or not at all (AtomicFile). The extension determines the format:
/// - .svg: a drawing in the coordinates of the plane, with y downwards as in images: one path of all closed lines,
///   filled by the even-odd rule, so that holes stay empty, and one of the open lines, not filled. 9 digits.
/// - .csv: columns x, y, z, contour (the number of the line, from 0) and, when a line is open, closed (0 or 1). All
///   digits. read_polylines() reads it.
/// - .ply .vtp: curves as write_polylines() writes them, with the vertex property `contour`.
/// Throws IoError, also for other extensions; InvalidInput when lines and points do not match or the view is not
/// finite.
void write_contour_lines(const std::string& path, const ContourLines& contours, const ContourFileOptions& options = {});

/// True when the extension is one of these.
bool is_contour_lines_file(const std::string& path);

}  // namespace csrbf
