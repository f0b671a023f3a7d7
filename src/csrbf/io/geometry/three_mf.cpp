#include "csrbf/core/error.hpp"
#include "csrbf/core/interruption.hpp"
#include "csrbf/io/files/text.hpp"
#include "csrbf/io/files/zip_archive.hpp"
#include "csrbf/io/geometry/formats.hpp"
#include "csrbf/io/geometry/properties.hpp"

#include <map>

namespace csrbf {
namespace {

// The parts of the package, by the 3MF core specification 1.3 and its extension for materials.
constexpr std::string_view content_types =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">)"
    R"(<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>)"
    R"(<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>
)";
constexpr std::string_view relationships =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">)"
    R"(<Relationship Target="/3D/3dmodel.model" Id="rel0" )"
    R"(Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>
)";
constexpr std::string_view head =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<model unit="millimeter" xml:lang="en-US" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02" )"
    R"(xmlns:m="http://schemas.microsoft.com/3dmanufacturing/material/2015/02"><resources>
)";

constexpr unsigned elements_between_pauses = 1U << 12;

// Colours are a list of different ones, to which the corners of triangles refer.
struct Colors {
  std::vector<Index> of_vertex;  // numbers in the list, or nothing
  std::string list;
};

Colors colors_of(const Mesh& mesh) {
  Colors colors;
  const ColorColumns columns = find_colors(mesh.properties);
  if (!columns.complete()) return colors;
  std::map<std::array<int, 3>, Index> known;
  colors.of_vertex.resize(static_cast<std::size_t>(mesh.vertices.cols()));
  for (Index i = 0; i < mesh.vertices.cols(); ++i) {
    const Point<3> rgb = columns.rgb(i);
    const std::array<int, 3> key{static_cast<int>(rgb[0]), static_cast<int>(rgb[1]), static_cast<int>(rgb[2])};
    const auto [entry, is_new] = known.try_emplace(key, std::ssize(known));
    colors.of_vertex[static_cast<std::size_t>(i)] = entry->second;
    if (!is_new) continue;
    std::array<char, 10> text{};
    std::snprintf(text.data(), text.size(), "#%02X%02X%02XFF", key[0] & 0xFF, key[1] & 0xFF, key[2] & 0xFF);
    colors.list += std::string("<m:color color=\"") + text.data() + "\"/>\n";
  }
  return colors;
}

void append_attribute(std::string& out, const char* name, double value) {
  out.append(" ").append(name).append("=\"");
  append_number(out, value);
  out += '"';
}

void append_attribute(std::string& out, const char* name, Index value) {
  out.append(" ").append(name).append("=\"").append(std::to_string(value)) += '"';
}

}  // namespace

std::string format_3mf(const Mesh& mesh) {
  require(mesh.triangles.cols() > 0, "write_mesh", "triangles", mesh.triangles.cols(),
          ".3mf files hold meshes; write points to .ply");
  require(mesh.vertices.allFinite(), "write_mesh", "vertices", "NaN or infinity", ".3mf files hold finite coordinates");
  const Colors colors = colors_of(mesh);
  const bool has_colors = !colors.of_vertex.empty();
  // Most programs read coordinates as float32; where that would lose digits, they are relative to the middle.
  Point<3> middle = Point<3>::Zero();
  if (float_coordinate_loss(mesh.vertices) > 0) middle = bounding_box<3>(mesh.vertices).center();
  std::string xml(head);
  if (has_colors) xml += "<m:colorgroup id=\"1\">\n" + colors.list + "</m:colorgroup>\n";
  xml += std::string("<object id=\"2\" type=\"model\"") + (has_colors ? " pid=\"1\" pindex=\"0\"" : "") +
         "><mesh><vertices>\n";
  InterruptionPoint pause(elements_between_pauses);
  for (Index i = 0; i < mesh.vertices.cols(); ++i) {
    pause();
    const Point<3> p = mesh.vertices.col(i) - middle;
    xml += "<vertex";
    append_attribute(xml, "x", p.x());
    append_attribute(xml, "y", p.y());
    append_attribute(xml, "z", p.z());
    xml += "/>\n";
  }
  xml += "</vertices><triangles>\n";
  for (Index t = 0; t < mesh.triangles.cols(); ++t) {
    pause();
    const auto corners = mesh.triangles.col(t);
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
    constexpr const char *names[] = {"v1", "v2", "v3"}, *color_names[] = {"p1", "p2", "p3"};
    xml += "<triangle";
    for (Index c = 0; c < 3; ++c) append_attribute(xml, names[c], Index{corners[c]});
    if (has_colors) {
      append_attribute(xml, "pid", Index{1});
      for (Index c = 0; c < 3; ++c)
        append_attribute(xml, color_names[c], colors.of_vertex[static_cast<std::size_t>(corners[c])]);
    }
    xml += "/>\n";
  }
  xml += "</triangles></mesh></object></resources><build><item objectid=\"2\"";
  if (!middle.isZero(0)) {
    xml += " transform=\"1 0 0 0 1 0 0 0 1";
    for (const double shift : middle) append_number(xml += ' ', shift);
    xml += '"';
  }
  xml += "/></build></model>\n";
  return zip_archive(
      {{"[Content_Types].xml", content_types}, {"_rels/.rels", relationships}, {"3D/3dmodel.model", xml}}, "the mesh");
}

}  // namespace csrbf
