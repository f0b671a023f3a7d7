#include "csrbf/io/polylines.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/atomic_file.hpp"
#include "csrbf/io/files/gzip_file.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/files/text.hpp"
#include "csrbf/io/geometry/formats.hpp"
#include "csrbf/io/geometry/properties.hpp"
#include "csrbf/io/mesh.hpp"
#include "csrbf/io/points.hpp"
#include "csrbf/io/vtk/formats.hpp"

#include <map>

namespace csrbf {
namespace {

constexpr const char* polyline_extensions = ".csv .txt .xyz .pts .obj .ply .vtp";

// Is there a column `contour` in the lines before the first number?
bool names_contours(std::string_view text) {
  constexpr std::string_view number = "+-.0123456789", separators = " \t,;#/\"";
  for (LineReader reader(text, ""); reader.next();) {
    const std::string_view line = reader.line();
    if (number.find(line.front()) != std::string_view::npos) return false;
    for (std::size_t begin = 0; begin < line.size();) {
      const std::size_t end = std::min(line.find_first_of(separators, begin), line.size());
      if (lower_case(line.substr(begin, end - begin)) == "contour") return true;
      begin = end + 1;
    }
  }
  return false;
}

// The first of the columns that has one of the names; null when there is none.
const Property* column_named(const PointCloud& cloud, std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names)
    for (const Property& p : cloud.properties)
      if (lower_case(p.name) == name) return &p;
  return nullptr;
}

Polylines parse_table_of_contours(std::string_view text, const std::string& name) {
  PointCloud cloud = parse_point_table(text, name);
  const Property* const contour = column_named(cloud, {"contour", "slice"});
  const Property* const closed = column_named(cloud, {"closed"});
  if (contour == nullptr)
    throw IoError(name + ": no column is named \"contour\"; name the columns in the first line: x,y,z,contour");
  std::map<double, std::vector<std::int32_t>> curves;
  for (Index i = 0; i < cloud.size(); ++i) {
    const double id = contour->values[i];
    if (!std::isfinite(id)) throw IoError(name + ": point " + std::to_string(i + 1) + " has no contour");
    curves[id].push_back(static_cast<std::int32_t>(i));
  }
  Polylines lines;
  lines.edges.resize(2, cloud.size());
  Index e = 0;
  for (const auto& [id, curve] : curves) {
    for (std::size_t i = 0; i + 1 < curve.size(); ++i) lines.edges.col(e++) << curve[i], curve[i + 1];
    if (closed == nullptr || closed->values[curve.back()] != 0) lines.edges.col(e++) << curve.back(), curve.front();
  }
  lines.edges.conservativeResize(2, e);
  lines.vertices = std::move(cloud.points);
  lines.properties = std::move(cloud.properties);
  return lines;
}

bool are_polylines(const std::string& extension, const std::string& bytes) {
  try {
    if (extension == ".ply") return is_ply_of_polylines(bytes);
    if (extension == ".vtp") return is_vtp_of_polylines(bytes);
    return extension == ".obj" ? is_obj_of_polylines(bytes) : names_contours(bytes);
  } catch (const IoError&) {
    return false;
  }
}

Polylines parse_all(const std::string& extension, const std::string& bytes, const std::string& name) {
  if (extension == ".ply") return parse_ply_polylines(bytes, name);
  if (extension == ".obj") return parse_obj_polylines(bytes, name);
  if (extension == ".vtp") return parse_vtp_polylines(bytes, name);
  return parse_table_of_contours(bytes, name);
}

Polylines parse_polylines(const std::string& extension, const std::string& bytes, const std::string& name) {
  Polylines lines = parse_all(extension, bytes, name);
  if (lines.edges.cols() == 0)
    throw IoError(name + ": the file holds " + std::to_string(lines.vertices.cols()) + " points but no curves");
  return lines;
}

}  // namespace

Polylines read_polylines(const std::string& path) {
  const Content content = read_with_format(path, polyline_extensions, ".csv", "files of curves");
  return parse_polylines(content.extension, content.bytes, display_name(path));
}

std::variant<Mesh, Polylines> read_points_or_polylines(const std::string& path) {
  const Content content = read_with_format(path, readable_point_formats(), ".xyz", "point files");
  const bool may_be = path != "-" && is_listed(content.extension, polyline_extensions);
  if (may_be && are_polylines(content.extension, content.bytes))
    return parse_polylines(content.extension, content.bytes, display_name(path));
  return parse_mesh_or_points(content.extension, content.bytes, display_name(path));
}

bool is_polylines_file(const std::string& path) {
  return is_listed(file_extension(path), ".ply .vtp");
}

void write_polylines(const std::string& path, const Polylines& lines) {
  if (!is_polylines_file(path)) refuse_extension(path, file_extension(path), "files of curves are .ply .vtp");
  const bool valid =
      lines.edges.size() == 0 || (lines.edges.minCoeff() >= 0 && lines.edges.maxCoeff() < lines.vertices.cols());
  require(valid, "write_polylines", "vertex index", "out of range", "indices must be in [0, number of vertices)");
  check_properties(lines.properties, lines.vertices.cols(), "write_polylines");
  write_file(path, file_extension(path) == ".vtp" ? format_vtp(lines) : format_ply(lines));
}

}  // namespace csrbf
