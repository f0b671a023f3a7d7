#include "csrbf/io/mesh.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/gzip_file.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/geometry/formats.hpp"
#include "csrbf/io/geometry/mesh_space.hpp"
#include "csrbf/io/geometry/properties.hpp"
#include "csrbf/io/points.hpp"
#include "csrbf/io/vtk/formats.hpp"

#include <sstream>

namespace csrbf {
namespace {

Mesh refuse_glb(std::string_view /*bytes*/, const std::string& name) {
  throw IoError(name + ": .glb is only written; export the mesh as .ply, .obj or .stl");
}

Mesh refuse_3mf(std::string_view /*bytes*/, const std::string& name) {
  throw IoError(name + ": .3mf is only written; export the mesh as .ply, .obj or .stl");
}

struct Format {
  std::string_view extension;
  Mesh (*parse)(std::string_view bytes, const std::string& name);
  std::string (*format)(const Mesh& mesh);
};

constexpr Format formats[] = {{".ply", parse_ply, format_ply}, {".obj", parse_obj, format_obj},
                              {".off", parse_off, format_off}, {".stl", parse_stl, format_stl},
                              {".vtp", parse_vtp, format_vtp}, {".glb", refuse_glb, format_glb},
                              {".3mf", refuse_3mf, format_3mf}};

std::string mesh_formats() {
  std::string known;
  for (const Format& format : formats) known += (known.empty() ? "" : " ") + std::string(format.extension);
  return known;
}

const Format* find_format(const std::string& path) {
  std::string extension = content_extension(path);
  if (path == "-" && extension.empty()) extension = ".off";
  for (const Format& format : formats)
    if (format.extension == extension) return &format;
  return nullptr;
}

const Format& checked_format(const std::string& path) {
  if (const Format* format = find_format(path)) return *format;
  refuse_extension(path, file_extension(path), "mesh files are " + mesh_formats());
}

Mesh parse(const Format& format, const std::string& bytes, const std::string& name) {
  Mesh mesh = format.parse(bytes, name);
  mesh.space = space_in(bytes, format.extension);
  return mesh;
}

void check(const Mesh& mesh) {
  const Index vertices = mesh.vertices.cols();
  require(mesh.normals.cols() == 0 || mesh.normals.cols() == vertices, "write_mesh", "normals", mesh.normals.cols(),
          "none or one per vertex is needed");
  check_properties(mesh.properties, vertices, "write_mesh");
  if (mesh.triangles.cols() == 0) return;
  require(mesh.triangles.minCoeff() >= 0 && mesh.triangles.maxCoeff() < vertices, "write_mesh", "largest vertex index",
          mesh.triangles.maxCoeff(), "indices must be in [0, number of vertices)");
}

std::vector<std::string> precision_warnings(const std::string& path, const Points<3>& vertices) {
  const double loss = float_coordinate_loss(vertices);
  if (loss == 0) return {};
  std::ostringstream text;
  text.precision(2);
  text << path << ": .stl holds single precision, which moves coordinates by up to " << loss
       << " here; write .ply, .obj or .off, or bring the data nearer to the origin";
  return {text.str()};
}

}  // namespace

Mesh read_mesh(const std::string& path) {
  const Content content = read_with_format(path, mesh_formats(), ".off", "mesh files");
  const auto is_that = [&](const Format& format) { return format.extension == content.extension; };
  Mesh mesh = parse(*std::find_if(std::begin(formats), std::end(formats), is_that), content.bytes, display_name(path));
  if (mesh.triangles.cols() == 0)
    throw IoError(display_name(path) + ": the file holds " + std::to_string(mesh.vertices.cols()) +
                  " points but no faces");
  return mesh;
}

Mesh read_mesh_or_points(const std::string& path) {
  for (const Format& format : formats)  // those that are only written say so
    if (format.extension == file_extension(path) && !is_listed(format.extension, readable_point_formats()))
      (void)format.parse("", display_name(path));
  const Content content = read_with_format(path, readable_point_formats(), ".xyz", "files of meshes and points");
  return parse_mesh_or_points(content.extension, content.bytes, display_name(path));
}

Mesh parse_mesh_or_points(const std::string& extension, const std::string& bytes, const std::string& name) {
  for (const Format& format : formats)
    if (format.extension == extension) return parse(format, bytes, name);
  PointCloud cloud = parse_points(extension, bytes, name);
  Mesh mesh;
  mesh.vertices = std::move(cloud.points);
  mesh.normals = std::move(cloud.normals);
  mesh.properties = std::move(cloud.properties);
  return mesh;
}

std::vector<std::string> write_mesh(const std::string& path, const Mesh& mesh) {
  const Format& format = checked_format(path);
  check(mesh);
  write_content(path, with_space(format.format(mesh), format.extension, mesh.space));
  return format.extension == ".stl" ? precision_warnings(path, mesh.vertices) : std::vector<std::string>();
}

bool is_mesh_file(const std::string& path) {
  return find_format(path) != nullptr;
}

}  // namespace csrbf
