#include "studio/coarse.hpp"

#include "csrbf/core/grid.hpp"
#include "csrbf/io/files/atomic_file.hpp"
#include "csrbf/io/files/gzip_file.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/files/text.hpp"
#include "csrbf/io/mesh.hpp"
#include "csrbf/io/points.hpp"
#include "csrbf/io/volume.hpp"
#include "report/surface_view.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace csrbf::app {
namespace fs = std::filesystem;
namespace {

constexpr Index few_points = 1500;    // a surface in .09 s of CPU time; 2000: .11
constexpr Index few_rows = 1500;      // a fit of given smoothing in .07 s of CPU time; 3000: .11
constexpr double few_pixels = 20000;  // of an image
constexpr double few_voxels = 30000;  // of a volume

// Every stride-th voxel along the axes longer than one, and the last one: seeds may lie there.
Volume<float> thinned(const Volume<float>& image) {
  const int dimension = image.grid.dimension();
  const double wanted = dimension == 3 ? few_voxels : few_pixels;
  const double ratio = static_cast<double>(image.grid.voxels()) / wanted;
  const auto stride = static_cast<Index>(std::ceil(std::pow(std::max(1.0, ratio), 1.0 / dimension)));
  VolumeLayout layout = image;
  layout.frames = 1;
  for (int a = 0; a < 3; ++a) {
    layout.grid.size[a] = 1 + (image.grid.size[a] + stride - 2) / stride;
    if (image.grid.size[a] > 1) layout.grid.spacing[a] *= static_cast<double>(stride);
  }
  Volume<float> result(layout);
  float* out = result.values.data();
  const auto& size = layout.grid.size;
  const std::array<Index, 3> last{image.grid.size[0] - 1, image.grid.size[1] - 1, image.grid.size[2] - 1};
  for (Index z = 0; z < size[2]; ++z)
    for (Index y = 0; y < size[1]; ++y)
      for (Index x = 0; x < size[0]; ++x) {
        const Index at = image.grid.index(std::min(x * stride, last[0]), std::min(y * stride, last[1]),
                                          std::min(z * stride, last[2]));
        out = std::copy_n(image.values.data() + image.components * at, image.components, out);
      }
  return result;
}

// Lines of numbers, evenly chosen; the lines before the first one that begins with a number are kept.
std::string thinned_lines(const std::string& text) {
  std::vector<std::string_view> lines;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    lines.push_back(std::string_view(text).substr(begin, end - begin));
    begin = end + 1;
  }
  std::string result;
  std::size_t head = 0;
  const auto begins_with_number = [](std::string_view line) {
    return parse_number(trimmed(line.substr(0, line.find_first_of(",;\t ")))).has_value();
  };
  while (head < lines.size() && head < 20 && !begins_with_number(lines[head])) ++head;
  for (std::size_t i = 0; i < head; ++i) result += std::string(lines[i]) + "\n";
  for (const Index i : spread_indices(std::ssize(lines) - static_cast<Index>(head), few_rows))
    result += std::string(lines[head + static_cast<std::size_t>(i)]) + "\n";
  return result;
}

PointCloud thinned(const PointCloud& cloud) {
  const std::vector<Index> chosen = spread_indices(cloud.size(), few_points);
  PointCloud few;
  few.points = cloud.points(Eigen::all, chosen);
  if (cloud.has_normals()) few.normals = cloud.normals(Eigen::all, chosen);
  for (const Property& p : cloud.properties) few.properties.push_back({p.name, p.type, p.values(chosen)});
  return few;
}

// The name of the copy: formats that are read but not written become another one.
std::string copy_name(const std::string& name) {
  const std::string extension = content_extension(name);
  if (is_listed(extension, ".csv .txt .tsv .dat .csrbf"))
    return extension == file_extension(name) ? name : name + extension;
  if (extension != ".npy" && is_readable_volume(name)) return name + ".nrrd";  // keeps spacing and space
  return extension == ".npy" || extension == ".xyz" ? name : name + ".ply";
}

void write_copy(const fs::path& file, const std::string& copy) {
  const std::string source = file.string(), extension = content_extension(copy);
  if (extension == ".nrrd") {
    write_volume(copy, thinned(read_volume(source)));
  } else if (extension == ".ply" || extension == ".xyz") {
    const Mesh mesh = read_mesh_or_points(source);
    if (mesh.triangles.cols() > 0)
      write_mesh(copy, mesh);
    else
      write_points(copy, thinned(read_points(source)));
  } else if (extension == ".csrbf" || extension == ".npy") {
    fs::remove(copy);
    fs::create_symlink(file, copy);
  } else {
    write_file(copy, thinned_lines(read_content(source)));
  }
}

}  // namespace

std::string coarse_copy(const fs::path& file, const fs::path& folder) {
  const std::string name = copy_name(file.filename().string());
  const fs::path copy = folder / name;
  std::error_code error;
  if (fs::exists(copy) && fs::last_write_time(copy, error) > fs::last_write_time(file)) return name;
  write_copy(fs::canonical(file), copy.string());
  return name;
}

}  // namespace csrbf::app
