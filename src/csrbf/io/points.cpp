#include "csrbf/io/points.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/joined.hpp"
#include "csrbf/io/files/gzip_file.hpp"
#include "csrbf/io/files/npy.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/geometry/formats.hpp"
#include "csrbf/io/geometry/properties.hpp"
#include "csrbf/io/vtk/formats.hpp"

#include <set>

namespace csrbf {
namespace {

const std::string extensions = ".ply .xyz .pts .txt .csv .obj .off .npy .vtp";
const std::string readable = extensions + " .stl .las .laz .e57 .pcd .ptx";

PointCloud points_of(Mesh&& mesh) {
  return {std::move(mesh.vertices), std::move(mesh.normals), std::move(mesh.properties)};
}

Mesh mesh_of(const PointCloud& cloud) {
  Mesh mesh;
  mesh.vertices = cloud.points;
  mesh.normals = cloud.normals;
  mesh.properties = cloud.properties;
  return mesh;
}

PointCloud points_of(const NpyArray& array, const std::string& name) {
  if (array.shape.size() != 2 || (array.shape[1] != 3 && array.shape[1] != 6)) {
    std::vector<std::string> shape;
    for (const Index length : array.shape) shape.push_back(std::to_string(length));
    throw IoError(name + ": the array has shape (" + joined(shape) + "), points need (n, 3), or (n, 6) with normals");
  }
  const Eigen::Map<const Eigen::MatrixXd> rows(array.values.data(), array.shape[1], array.shape[0]);
  PointCloud cloud;
  cloud.points = rows.topRows(3);
  if (rows.rows() == 6 && rows.cols() > 0) cloud.normals = rows.bottomRows(3);
  return cloud;
}

NpyArray array_of(const PointCloud& cloud) {
  const Index columns = cloud.has_normals() ? 6 : 3;
  NpyArray array{{cloud.size(), columns}, std::vector<double>(columns * cloud.size())};
  Eigen::Map<Eigen::MatrixXd> rows(array.values.data(), columns, cloud.size());
  rows.topRows(3) = cloud.points;
  if (cloud.has_normals()) rows.bottomRows(3) = cloud.normals;
  return array;
}

}  // namespace

PointCloud parse_points(const std::string& extension, const std::string& bytes, const std::string& name) {
  if (extension == ".ply") return points_of(parse_ply(bytes, name));
  if (extension == ".obj") return points_of(parse_obj(bytes, name));
  if (extension == ".off") return points_of(parse_off(bytes, name));
  if (extension == ".npy") return points_of(parse_npy(bytes, name), name);
  if (extension == ".vtp") return points_of(parse_vtp(bytes, name));
  if (extension == ".stl") return points_of(parse_stl(bytes, name));
  if (extension == ".las" || extension == ".laz") return parse_laz(bytes, name);
  if (extension == ".e57") return parse_e57(bytes, name);
  if (extension == ".ptx") return parse_ptx(bytes, name);
  if (extension == ".pcd") return parse_pcd(bytes, name);
  return parse_point_table(bytes, name);
}

namespace {

// What was asked for, and which classes there are.
std::string description(const PointSelection& selection, const Eigen::VectorXd* classes) {
  std::vector<std::string> wanted;
  for (const int c : selection.classes) wanted.push_back(std::to_string(c));
  std::string text = wanted.empty() ? "" : "class " + joined(wanted);
  if (selection.returns != "all") text += (text.empty() ? "" : " and is the ") + selection.returns + " return";
  if (classes == nullptr) return text;
  const std::set<double> known(classes->begin(), classes->end());
  std::vector<std::string> all;
  for (const double c : known) all.push_back(std::to_string(static_cast<int>(c)));
  return text + "; the classes are " + joined(all);
}

std::string format_points(const std::string& extension, const PointCloud& cloud) {
  if (extension == ".ply") return format_ply(mesh_of(cloud));
  if (extension == ".obj") return format_obj(mesh_of(cloud));
  if (extension == ".off") return format_off(mesh_of(cloud));
  if (extension == ".npy") return format_npy(array_of(cloud));
  if (extension == ".vtp") return format_vtp(mesh_of(cloud));
  if (extension == ".csv") return format_point_table(cloud, TableStyle::csv);
  if (extension == ".txt") return format_point_table(cloud, TableStyle::txt);
  return format_point_table(cloud, extension == ".pts" ? TableStyle::pts : TableStyle::xyz);
}

// The properties that a file of points has no place for, if any.
std::vector<std::string> property_warnings(const std::string& path, const std::string& extension,
                                           const PointCloud& cloud) {
  if (is_listed(extension, ".ply .vtp .csv .txt")) return {};
  const bool has_colors = is_listed(extension, ".obj .off") && find_colors(cloud.properties).complete();
  std::vector<std::string> lost;
  for (const Property& p : cloud.properties)
    if (!has_colors || !is_listed(p.name, "red green blue alpha")) lost.push_back(p.name);
  if (lost.empty()) return {};
  return {path + ": " + extension + " has no place for " + joined(lost) + "; .ply, .vtp, .csv and .txt have"};
}

}  // namespace

PointCloud read_points(const std::string& path) {
  const Content content = read_with_format(path, readable, ".xyz", "point files");
  return parse_points(content.extension, content.bytes, display_name(path));
}

const std::string& readable_point_formats() {
  return readable;
}

PointCloud select_points(const PointCloud& cloud, const PointSelection& selection) {
  if (selection.is_all()) return cloud;
  const auto property = [&](const char* name) -> const Eigen::VectorXd& {
    for (const Property& p : cloud.properties)
      if (p.name == name) return p.values;
    throw InvalidInput(std::string("the points have no property ") + name + ", by which they were to be selected");
  };
  require(is_listed(selection.returns, "all first last only"), "select_points", "returns", selection.returns,
          "must be all, first, last or only");
  const Eigen::VectorXd* const classes = selection.classes.empty() ? nullptr : &property("classification");
  const bool by_return = selection.returns != "all";
  const Eigen::VectorXd* const number = by_return ? &property("return_number") : nullptr;
  const Eigen::VectorXd* const count = by_return ? &property("number_of_returns") : nullptr;
  const auto is_wanted = [&](Index i) {
    if (classes != nullptr && std::none_of(selection.classes.begin(), selection.classes.end(),
                                           [&](int wanted) { return (*classes)[i] == wanted; }))
      return false;
    if (!by_return) return true;
    return (selection.returns == "last" || (*number)[i] <= 1) &&
           (selection.returns == "first" || (*number)[i] >= (*count)[i]);
  };
  std::vector<Index> kept;
  for (Index i = 0; i < cloud.size(); ++i)
    if (is_wanted(i)) kept.push_back(i);
  if (kept.empty()) throw InvalidInput("no point has " + description(selection, classes));
  PointCloud some;
  some.points = cloud.points(Eigen::all, kept);
  if (cloud.has_normals()) some.normals = cloud.normals(Eigen::all, kept);
  for (const Property& p : cloud.properties) some.properties.push_back({p.name, p.type, p.values(kept)});
  return some;
}

std::vector<std::string> write_points(const std::string& path, const PointCloud& cloud) {
  std::string extension = content_extension(path);
  if (path == "-" && extension.empty()) extension = ".xyz";
  if (!is_listed(extension, extensions))
    refuse_extension(path, extension, "point files are " + extensions + ", also as .gz");
  require(cloud.normals.cols() == 0 || cloud.has_normals(), "write_points", "normals", cloud.normals.cols(),
          "none or one per point is needed");
  check_properties(cloud.properties, cloud.size(), "write_points");
  write_content(path, format_points(extension, cloud));
  return property_warnings(path, extension, cloud);
}

bool is_point_file(const std::string& path) {
  return path == "-" || is_listed(content_extension(path), extensions);
}

bool is_readable_point_file(const std::string& path) {
  return path == "-" || is_listed(content_extension(path), readable);
}

}  // namespace csrbf
