#include "csrbf/io/contour_lines.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/numbers/number_text.hpp"
#include "csrbf/io/files/atomic_file.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/files/text.hpp"
#include "csrbf/io/gdal/gdal.hpp"
#include "csrbf/io/polylines.hpp"

#include <Eigen/Geometry>

#include <array>

namespace csrbf {
namespace {

// Shorter than append_number, with an error still far below what can be seen.
void append_coordinate(std::string& out, double value) {
  constexpr int digits = 9;
  std::array<char, 32> text{};
  out.append(text.data(), write_number(text.data(), text.data() + text.size(), value, digits));
}

void append_coordinates(std::string& out, const Point<2>& p) {
  append_coordinate(out, p[0]);
  out += ' ';
  append_coordinate(out, p[1]);
}

std::string path_data(const ContourLines& contours, bool closed) {
  std::string d;
  for (const ContourLine& line : contours.lines) {
    if (line.closed != closed) continue;
    for (Index i = 0; i < line.size; ++i) {
      d += i == 0 ? "M" : i == 1 ? "L" : " ";
      append_coordinates(d, contours.points.col(line.begin + i));
    }
    d += closed ? "Z\n" : "\n";
  }
  return d;
}

// The box that is shown; its area is never zero.
Box<2> view_of(const ContourLines& contours, const Box<2>& wanted) {
  constexpr double margin = 0.02;  // of the longest side, by eye
  if (!wanted.empty()) {
    require(wanted.extent().allFinite() && wanted.extent().minCoeff() > 0, "write_contour_lines", "view",
            wanted.extent().transpose().format(Eigen::IOFormat(Eigen::StreamPrecision, 0, " x ")),
            "must have positive, finite extent along both axes; leave it out for that of the points");
    return wanted;
  }
  const Box<2> box = bounding_box<2>(contours.points);
  const double longest = box.extent().maxCoeff();
  if (box.empty() || !(longest > 0)) return {Point<2>(0, 0), Point<2>(1, 1)};
  return box.inflated(margin * longest);
}

std::string format_svg(const ContourLines& contours, const Box<2>& wanted) {
  constexpr double pixels = 800;       // along the longest side, by eye
  constexpr double line_width = 2e-3;  // of it, by eye
  const Box<2> view = view_of(contours, wanted);
  const double longest = view.extent().maxCoeff();
  std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"";
  append_coordinates(svg, view.lo);
  svg += ' ';
  append_coordinates(svg, view.extent());
  svg += "\" width=\"";
  append_coordinate(svg, pixels * view.extent()[0] / longest);
  svg += "\" height=\"";
  append_coordinate(svg, pixels * view.extent()[1] / longest);
  svg += "\" stroke=\"#c00000\" stroke-linejoin=\"round\" stroke-width=\"";
  append_coordinate(svg, line_width * longest);
  svg += "\">\n";
  const std::string closed = path_data(contours, true), open = path_data(contours, false);
  if (!closed.empty())
    svg += "<path fill=\"#c00000\" fill-opacity=\"0.25\" fill-rule=\"evenodd\" d=\"\n" + closed + "\"/>\n";
  if (!open.empty()) svg += "<path fill=\"none\" d=\"\n" + open + "\"/>\n";
  return svg + "</svg>\n";
}

std::string format_csv(const ContourLines& contours, const Eigen::Affine3d& placement) {
  const bool any_open =
      std::any_of(contours.lines.begin(), contours.lines.end(), [](const ContourLine& line) { return !line.closed; });
  std::string csv = any_open ? "x,y,z,contour,closed\n" : "x,y,z,contour\n";
  for (std::size_t n = 0; n < contours.lines.size(); ++n) {
    const ContourLine& line = contours.lines[n];
    for (Index i = line.begin; i < line.begin + line.size; ++i) {
      const Point<3> p = placement * Point<3>(contours.points(0, i), contours.points(1, i), 0);
      for (const double x : p) {
        append_number(csv, x);
        csv += ',';
      }
      csv += std::to_string(n) + (any_open ? line.closed ? ",1\n" : ",0\n" : "\n");
    }
  }
  return csv;
}

std::string format_level_csv(const std::vector<LevelLine>& lines, const LevelFileOptions& options) {
  std::string csv;
  for (const std::string& name : {options.coordinate_names[0], options.coordinate_names[1], options.value_name})
    csv += name + ",";
  csv += "contour,closed\n";
  for (std::size_t n = 0; n < lines.size(); ++n)
    for (const auto p : lines[n].points.colwise()) {
      for (const double x : {p[0], p[1], lines[n].level}) {
        append_number(csv, x);
        csv += ',';
      }
      csv += std::to_string(n) + (lines[n].closed ? ",1\n" : ",0\n");
    }
  return csv;
}

}  // namespace

void write_contour_lines(const std::string& path, const ContourLines& contours, const ContourFileOptions& options) {
  const std::string extension = file_extension(path);
  if (!is_contour_lines_file(path)) refuse_extension(path, extension, "contours in the plane are .svg .csv .ply .vtp");
  for (const ContourLine& line : contours.lines)
    require(line.begin >= 0 && line.size > 0 && line.begin + line.size <= contours.points.cols(), "write_contour_lines",
            "end of a line", line.begin + line.size, "must not be beyond the points");
  if (extension == ".svg") return write_file(path, format_svg(contours, options.view));
  if (extension == ".csv") return write_file(path, format_csv(contours, Eigen::Affine3d(options.placement)));
  write_polylines(path, to_polylines(contours, options.placement));
}

bool is_contour_lines_file(const std::string& path) {
  return is_listed(file_extension(path), ".svg .csv .ply .vtp");
}

bool is_level_lines_file(const std::string& path) {
  const std::string extension = file_extension(path);
  return is_listed(extension, ".csv .ply .vtp") || is_gdal_table(extension);
}

void write_level_lines(const std::string& path, const std::vector<LevelLine>& lines, const LevelFileOptions& options) {
  const std::string extension = file_extension(path);
  if (!is_level_lines_file(path))
    refuse_extension(path, extension, "contour lines are .csv .ply .vtp, and .gpkg .shp .geojson .fgb");
  if (extension == ".csv") return write_file(path, format_level_csv(lines, options));
  if (!is_gdal_table(extension)) return write_polylines(path, to_polylines(lines));
  std::vector<Points<2>> vertices;
  Eigen::VectorXd levels(std::ssize(lines));
  for (const LevelLine& line : lines) {
    levels[std::ssize(vertices)] = line.level;
    vertices.push_back(line.points);
    if (!line.closed) continue;
    vertices.back().conservativeResize(2, line.points.cols() + 1);
    vertices.back().rightCols<1>() = line.points.col(0);
  }
  write_gdal_lines(path, vertices, options.value_name, levels, options.crs);
}

}  // namespace csrbf
