#include "csrbf/io/points.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/joined.hpp"
#include "csrbf/io/files/gzip_file.hpp"
#include "csrbf/io/files/npy.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/geometry/formats.hpp"
#include "csrbf/io/vtk/formats.hpp"

namespace csrbf {
namespace {

const std::string extensions = ".ply .xyz .pts .txt .csv .obj .off .npy .vtp";
const std::string only_read = " .las .pcd";

// The format of a path: its extension, or .xyz for the standard streams.
std::string checked_extension(const std::string& path, const std::string& known) {
  const std::string extension = path == "-" ? ".xyz" : content_extension(path);
  if (extension == ".laz" || extension == ".e57")
    refuse_extension(path, extension, "convert it to .las, as with CloudCompare or PDAL");
  if (!is_listed(extension, known)) refuse_extension(path, extension, "point files are " + known + ", also as .gz");
  return extension;
}

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

PointCloud parse_points_as(const std::string& extension, const std::string& bytes, const std::string& name) {
  if (extension == ".ply") return points_of(parse_ply(bytes, name));
  if (extension == ".obj") return points_of(parse_obj(bytes, name));
  if (extension == ".off") return points_of(parse_off(bytes, name));
  if (extension == ".npy") return points_of(parse_npy(bytes, name), name);
  if (extension == ".vtp") return points_of(parse_vtp(bytes, name));
  if (extension == ".las") return parse_las(bytes, name);
  if (extension == ".pcd") return parse_pcd(bytes, name);
  return parse_point_table(bytes, name);
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

}  // namespace

PointCloud read_points(const std::string& path) {
  const std::string extension = checked_extension(path, extensions + only_read);
  return parse_points_as(extension, read_content(path), display_name(path));
}

PointCloud parse_points(const std::string& bytes, const std::string& path) {
  return parse_points_as(checked_extension(path, extensions + only_read), bytes, display_name(path));
}

void write_points(const std::string& path, const PointCloud& cloud) {
  const std::string extension = checked_extension(path, extensions);
  require(cloud.normals.cols() == 0 || cloud.has_normals(), "write_points", "normals", cloud.normals.cols(),
          "none or one per point is needed");
  write_content(path, format_points(extension, cloud));
}

bool is_point_file(const std::string& path) {
  return path == "-" || is_listed(content_extension(path), extensions);
}

}  // namespace csrbf
