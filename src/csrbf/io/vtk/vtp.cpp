#include "csrbf/io/vtk/formats.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/text.hpp"
#include "csrbf/io/geometry/properties.hpp"
#include "csrbf/io/vtk/vtk.hpp"

namespace csrbf {
namespace {

// Properties have no 64-bit integer type; their values are doubles anyway.
std::string property_type(SampleType type) {
  const std::string_view name = name_of(type, property_types);
  return std::string(name.empty() ? "double" : name);
}

constexpr const char* axis_names[] = {"x", "y", "z"};
constexpr const char* color_names[] = {"red", "green", "blue", "alpha"};

// Writing.

// The common name of properties i to i + 2 before x, y and z; empty when they are not a vector.
std::string vector_name(const std::vector<Property>& properties, std::size_t i) {
  if (i + 3 > properties.size() || properties[i].name.size() < 2) return {};
  const std::string stem = properties[i].name.substr(0, properties[i].name.size() - 1);
  for (std::size_t a = 0; a < 3; ++a)
    if (properties[i + a].name != stem + axis_names[a] || properties[i + a].type != properties[i].type) return {};
  return stem;
}

VtkArray array_of(const std::string& name, SampleType type, const Eigen::Ref<const Eigen::MatrixXd>& values) {
  return {name, type, values.rows(), vtk_bytes(type, values)};
}

VtkArray colors_of(const ColorColumns& colors, Index points) {
  Eigen::MatrixXd rgb(3, points);
  for (Index i = 0; i < points; ++i) rgb.col(i) = colors.rgb(i);
  return array_of("RGB", SampleType::uint8, rgb);
}

std::string point_data(const std::vector<Property>& properties, const Points<3>& normals, Index points,
                       VtkWriter& writer) {
  const ColorColumns colors = find_colors(properties);
  std::string arrays, scalars;
  const auto add = [&](VtkArray array) {
    if (scalars.empty()) scalars = array.name;
    arrays += writer.array(std::move(array));
  };
  if (colors.complete()) add(colors_of(colors, points));
  for (std::size_t i = 0; i < properties.size(); ++i) {
    const Property& p = properties[i];
    if (colors.complete() && (&p == colors.red || &p == colors.green || &p == colors.blue)) continue;
    const SampleType type = type_named(p.type, property_types).value_or(SampleType::float64);
    const std::string name = vector_name(properties, i);
    if (name.empty()) {
      add(array_of(p.name, type, p.values.transpose()));
      continue;
    }
    Eigen::MatrixXd vectors(3, points);
    vectors << p.values.transpose(), properties[i + 1].values.transpose(), properties[i + 2].values.transpose();
    arrays += writer.array(array_of(name, type, vectors));
    i += 2;
  }
  const bool has_normals = normals.cols() > 0;
  if (has_normals) arrays += writer.array(array_of("Normals", SampleType::float32, normals));
  const std::string active = (scalars.empty() ? "" : " Scalars=\"" + xml_escaped(scalars) + "\"") +
                             std::string(has_normals ? " Normals=\"Normals\"" : "");
  return "<PointData" + active + ">\n" + arrays + "</PointData>\n";
}

// An element Verts, Lines or Polys: cells of `corners` points each, which `indices` lists.
std::string cells(const std::string& element, const Eigen::Ref<const Eigen::MatrixXd>& indices, VtkWriter& writer) {
  const Index n = indices.cols(), corners = indices.rows();
  const Eigen::MatrixXd ends = static_cast<double>(corners) * (Eigen::RowVectorXd::LinSpaced(n, 1, double(n)));
  VtkArray connectivity = array_of("connectivity", SampleType::int64, indices);
  connectivity.components = 1;
  return "<" + element + ">\n" + writer.array(std::move(connectivity)) +
         writer.array(array_of("offsets", SampleType::int64, ends)) + "</" + element + ">\n";
}

std::string format_vtp(const Points<3>& points, const Points<3>& normals, const std::vector<Property>& properties,
                       const std::string& element, const Eigen::MatrixXd& indices) {
  VtkWriter writer;
  std::string counts;
  for (const char* kind : {"Verts", "Lines", "Strips", "Polys"})
    counts += std::string(" NumberOf") + kind + "=\"" + std::to_string(kind == element ? indices.cols() : 0) + "\"";
  std::string content = "<PolyData>\n<Piece NumberOfPoints=\"" + std::to_string(points.cols()) + "\"" + counts + ">\n";
  content += point_data(properties, normals, points.cols(), writer);
  const SampleType type = float_coordinate_loss(points) > 0 ? SampleType::float64 : SampleType::float32;
  content += "<Points>\n" + writer.array(array_of("Points", type, points)) + "</Points>\n";
  content += cells(element, indices, writer) + "</Piece>\n</PolyData>\n";
  const FileParts parts = writer.file("PolyData", content);
  return parts.head + parts.body;
}

// Reading.

class VtpParser {
 public:
  VtpParser(std::string_view bytes, const std::string& name) : reader_(bytes, "PolyData", name) {}

  Mesh parse() {
    read_points();
    read_cells("Polys", [this](const Cell& cell) { add_polygon(cell); });
    read_cells("Strips", [this](const Cell& cell) { add_strip(cell); });
    mesh_.triangles = Eigen::Map<const Triangles>(corners_.data(), 3, static_cast<Index>(corners_.size() / 3));
    read_point_data();
    return std::move(mesh_);
  }

  Polylines parse_lines() {
    read_points();
    read_cells("Lines", [this](const Cell& cell) {
      for (Index i = 1; i < cell.size(); ++i) corners_.insert(corners_.end(), {corner(cell, i - 1), corner(cell, i)});
    });
    read_point_data();
    Polylines lines;
    lines.vertices = std::move(mesh_.vertices);
    lines.edges = Eigen::Map<const Eigen::Matrix2X<std::int32_t>>(corners_.data(), 2, std::ssize(corners_) / 2);
    lines.properties = std::move(mesh_.properties);
    return lines;
  }

  [[nodiscard]] bool has_lines_alone() {
    const auto count = [&](const std::string& cells) { return reader_.count(reader_.piece(), "NumberOf" + cells); };
    return count("Lines") > 0 && count("Verts") == 0 && count("Polys") == 0 && count("Strips") == 0;
  }

 private:
  using Cell = Eigen::Ref<const Eigen::VectorXd>;  // the numbers of its vertices

  void read_points() {
    points_ = reader_.count(reader_.piece(), "NumberOfPoints");
    const XmlElement* points = reader_.piece().child("Points");
    const XmlElement* coordinates = points == nullptr ? nullptr : points->child("DataArray");
    if (coordinates == nullptr) reader_.fail("the file has no points");
    if (reader_.components(*coordinates) != 3) reader_.fail("the points do not have 3 coordinates");
    mesh_.vertices = reader_.values(*coordinates, points_);
  }

  static const XmlElement* array_named(const XmlElement& element, std::string_view wanted) {
    for (const XmlElement& array : element.children)
      if (const std::string* name = array.attribute("Name"); name != nullptr && *name == wanted) return &array;
    return nullptr;
  }

  template <class Add>
  void read_cells(const std::string& kind, const Add& add) {
    const XmlElement* element = reader_.piece().child(kind);
    const Index cells = reader_.count(reader_.piece(), "NumberOf" + kind);
    if (element == nullptr || cells == 0) return;
    const XmlElement* connectivity = array_named(*element, "connectivity");
    const XmlElement* offsets = array_named(*element, "offsets");
    if (connectivity == nullptr || offsets == nullptr) reader_.fail(kind + " have no connectivity or offsets");
    const Eigen::MatrixXd ends = reader_.values(*offsets, cells);
    double begin = 0;
    for (const double end : ends.reshaped()) {
      if (!(end >= begin && end <= 1e12)) reader_.fail("the offsets of " + kind + " do not ascend");
      begin = end;
    }
    const Eigen::MatrixXd indices = reader_.values(*connectivity, static_cast<Index>(begin));
    if (indices.size() > 0 && !(indices.minCoeff() >= 0 && indices.maxCoeff() < static_cast<double>(points_)))
      reader_.fail(kind + " refer to vertices that are not among the " + std::to_string(points_) + " points");
    Index first = 0;
    for (const double end : ends.reshaped()) {
      add(indices.reshaped().segment(first, static_cast<Index>(end) - first));
      first = static_cast<Index>(end);
    }
  }

  static std::int32_t corner(const Cell& cell, Index i) { return static_cast<std::int32_t>(cell[i]); }

  void add_triangle(const Cell& cell, Index a, Index b, Index c) {
    corners_.insert(corners_.end(), {corner(cell, a), corner(cell, b), corner(cell, c)});
  }

  void add_polygon(const Cell& cell) {
    for (Index i = 2; i < cell.size(); ++i) add_triangle(cell, 0, i - 1, i);
  }

  void add_strip(const Cell& cell) {
    for (Index i = 2; i < cell.size(); ++i) add_triangle(cell, i - 2 + i % 2, i - 1 - i % 2, i);
  }

  void read_point_data() {
    const XmlElement* data = reader_.piece().child("PointData");
    if (data == nullptr) return;
    const std::string* normals = data->attribute("Normals");
    for (const XmlElement& array : data->children) {
      const std::string* name = array.attribute("Name");
      const std::string* type = array.attribute("type");
      if (array.name != "DataArray" || name == nullptr || type == nullptr || *type == "String") continue;
      const Eigen::MatrixXd values = reader_.values(array, points_);
      if (values.rows() == 3 && *name == (normals == nullptr ? "Normals" : *normals))
        mesh_.normals = values;
      else
        add_properties(*name, reader_.type(array), values);
    }
  }

  void add_properties(const std::string& name, SampleType type, const Eigen::MatrixXd& values) {
    if (values.cols() == 0) return;
    const Index n = values.rows();
    const bool is_color = type == SampleType::uint8 && (n == 3 || n == 4) && !find_colors(mesh_.properties).complete();
    for (Index row = 0; row < n; ++row) {
      std::string part = single_word(name);
      if (is_color)
        part = color_names[row];
      else if (n == 3)
        part += axis_names[row];
      else if (n > 1)
        part += "_" + std::to_string(row);
      mesh_.properties.push_back({part, property_type(type), values.row(row).transpose()});
    }
  }

  VtkReader reader_;
  Index points_ = 0;
  std::vector<std::int32_t> corners_;
  Mesh mesh_;
};

}  // namespace

Mesh parse_vtp(std::string_view bytes, const std::string& name) {
  return VtpParser(bytes, name).parse();
}

bool is_vtp_of_polylines(std::string_view bytes) {
  return VtpParser(bytes, "").has_lines_alone();
}

Polylines parse_vtp_polylines(std::string_view bytes, const std::string& name) {
  return VtpParser(bytes, name).parse_lines();
}

std::string format_vtp(const Mesh& mesh) {
  const Index n = mesh.vertices.cols();
  if (mesh.triangles.cols() > 0)
    return format_vtp(mesh.vertices, mesh.normals, mesh.properties, "Polys", mesh.triangles.cast<double>());
  const Eigen::MatrixXd each = Eigen::RowVectorXd::LinSpaced(n, 0, static_cast<double>(n - 1));
  return format_vtp(mesh.vertices, mesh.normals, mesh.properties, "Verts", each);
}

std::string format_vtp(const Polylines& lines) {
  return format_vtp(lines.vertices, Points<3>(3, 0), lines.properties, "Lines", lines.edges.cast<double>());
}

}  // namespace csrbf
