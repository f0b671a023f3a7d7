#pragma once

#include "csrbf/core/mesh.hpp"

#include <string>
#include <string_view>

namespace csrbf {

/// Layouts of points in text: .xyz rows only, .pts with the number of rows first, .txt with names in a comment, .csv
/// with names and commas.
enum class TableStyle { xyz, pts, txt, csv };

/// Reads points from rows of numbers; read_points() documents how columns are interpreted. Throws IoError.
PointCloud parse_point_table(std::string_view text, const std::string& name);

/// Points as text; .xyz and .pts keep coordinates and normals only.
std::string format_point_table(const PointCloud& cloud, TableStyle style);

}  // namespace csrbf
