#include "commands/segment_contours.hpp"

#include "commands/formats.hpp"
#include "report/segment_page.hpp"

#include "csrbf/io/contour_lines.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/mesh.hpp"

namespace csrbf::app {
namespace {

Json described_contours(const ImageContour& contour) {
  const ContourLines& c = contour.lines;
  return {{"lines", c.lines.size()},
          {"length", c.length},
          {"length_error", c.length_error},
          {"area", c.area},
          {"area_error", c.area_error}};
}

Json described_contours(const ImageSurface& surface) {
  return {{"vertices", surface.mesh.vertices.cols()},
          {"triangles", surface.mesh.triangles.cols()},
          {"area", surface.area},
          {"area_error", surface.area_error},
          {"volume", surface.volume},
          {"volume_error", surface.volume_error}};
}

std::string with_error(double value, double error) {
  return rounded(value, 6) + " (error about " + rounded(error, 1) + ")";
}

std::string summary(const Json& total, int dim) {
  const auto measure = [&](const char* name) {
    return std::string(name) + " " + with_error(total[name], total[std::string(name) + "_error"]);
  };
  return dim == 2 ? measure("length") + ", " + measure("area") : measure("area") + ", " + measure("volume");
}

void add_to(Json& total, const Json& one) {
  for (const auto& [name, value] : one.items()) {
    if (!total.contains(name))
      total[name] = value;
    else if (value.is_number_float())
      total[name] = total[name].get<double>() + value.get<double>();
    else
      total[name] = total[name].get<Index>() + value.get<Index>();
  }
}

ImageContour joined(const std::vector<ImageContour>& contours) {
  ImageContour all = contours.front();
  for (std::size_t i = 1; i < contours.size(); ++i) {
    const ContourLines& more = contours[i].lines;
    ContourLines& lines = all.lines;
    const Index before = lines.points.cols();
    lines.points.conservativeResize(2, before + more.points.cols());
    lines.points.rightCols(more.points.cols()) = more.points;
    for (ContourLine line : more.lines) {
      line.begin += before;
      lines.lines.push_back(line);
    }
  }
  return all;
}

// One mesh; with several regions, its vertices carry the label of theirs.
Mesh joined(const std::vector<ImageSurface>& surfaces) {
  if (surfaces.size() == 1) return surfaces.front().mesh;
  Index vertices = 0, triangles = 0;
  for (const ImageSurface& surface : surfaces) {
    vertices += surface.mesh.vertices.cols();
    triangles += surface.mesh.triangles.cols();
  }
  Mesh all;
  all.space = surfaces.front().mesh.space;
  all.vertices.resize(3, vertices);
  all.normals.resize(3, vertices);
  all.triangles.resize(3, triangles);
  all.properties = {{"region", "int", Eigen::VectorXd(vertices)}};
  vertices = triangles = 0;
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    const Mesh& mesh = surfaces[i].mesh;
    const Index v = mesh.vertices.cols(), t = mesh.triangles.cols();
    all.vertices.middleCols(vertices, v) = mesh.vertices;
    all.normals.middleCols(vertices, v) = mesh.normals;
    all.triangles.middleCols(triangles, t) = mesh.triangles.array() + static_cast<std::int32_t>(vertices);
    all.properties[0].values.segment(vertices, v).setConstant(static_cast<double>(i + 1));
    vertices += v;
    triangles += t;
  }
  return all;
}

}  // namespace

template <int Dim>
SegmentContours<Dim>::SegmentContours(const Segmentation<Dim>& segmentation, const Grid& grid,
                                      const Progress& progress) {
  for (const Field<Dim>* field : inside_fields(segmentation))
    contours_.push_back(image_contour(*field, grid, {.progress = progress}));
}

template <int Dim>
void SegmentContours<Dim>::measure(Session& session) const {
  Json total = Json::object(), regions = Json::array();
  for (std::size_t i = 0; i < contours_.size(); ++i) {
    const Json one = described_contours(contours_[i]);
    Json region = {{"label", i + 1}};
    region.update(one);
    regions.push_back(region);
    add_to(total, one);
  }
  session.say("contour: " + summary(total, Dim));
  if (regions.size() > 1) total["regions"] = regions;
  session.result["contour"] = total;
}

template <>
std::vector<std::string> SegmentContours<2>::write(const std::string& path) const {
  const ImageContour all = joined(contours_);
  write_contour_lines(path, all.lines, {.placement = all.placement, .view = all.image});
  return {};
}

template <>
std::vector<std::string> SegmentContours<3>::write(const std::string& path) const {
  return write_mesh(path, joined(contours_));
}

template <>
Mesh SegmentContours<2>::mesh() const {
  return {};
}

template <>
Mesh SegmentContours<3>::mesh() const {
  return joined(contours_);
}

template class SegmentContours<2>;
template class SegmentContours<3>;

bool is_contour_file(const std::string& path) {
  return is_contour_lines_file(path) || is_mesh_file(path);
}

void check_contour_file(const std::string& path, int dimension) {
  if (dimension == 2 ? is_contour_lines_file(path) : is_mesh_file(path)) return;
  throw UsageError("--contour " + path + ": unknown extension \"" + file_extension(path) + "\"; contours in " +
                   (dimension == 2 ? std::string("the plane are ") + plane_contour_formats
                                   : std::string("space are ") + written_mesh_formats));
}

}  // namespace csrbf::app
