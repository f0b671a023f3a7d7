#include "csrbf/io/images/nrrd.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/deflate.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/files/text.hpp"
#include "csrbf/io/images/nrrd_header.hpp"
#include "csrbf/io/images/raw_data.hpp"

namespace csrbf {
namespace {

// Removes the axes of components from the front and of time from the back; the rest lie in space.
void set_shape(std::vector<NrrdAxis> axes, const NrrdHeader& header, VolumeLayout& layout, const std::string& name) {
  const bool placed = std::any_of(axes.begin(), axes.end(), [](const NrrdAxis& a) { return a.direction.has_value(); });
  const auto in_space = [&](const NrrdAxis& axis) {
    return !axis.is_components() && axis.kind != "time" && (!placed || axis.direction);
  };
  if (!in_space(axes.front()) && axes.front().kind != "time") {
    layout.components = axes.front().size;
    axes.erase(axes.begin());
  }
  if (axes.size() > 1 && (!in_space(axes.back()) || axes.size() == 4)) {
    layout.frames = axes.back().size;
    if (axes.back().spacing > 0) layout.time_step = axes.back().spacing;
    axes.pop_back();
  }
  if (axes.empty() || axes.size() > 3 || !std::all_of(axes.begin(), axes.end(), in_space))
    throw IoError(name +
                  ": the kinds of the axes are not supported; they must be components, up to three in space, time");
  Grid& grid = layout.grid;
  grid.axes = static_cast<int>(axes.size());
  Eigen::Matrix3d linear = Eigen::Matrix3d::Identity();
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const auto axis = static_cast<Index>(i);
    grid.size[i] = axes[i].size;
    if (axes[i].direction)
      linear.col(axis) = *axes[i].direction;
    else if (axes[i].spacing > 0)
      linear(axis, axis) = axes[i].spacing;
  }
  // A slice in space does not define its normal.
  if (placed && grid.axes == 2 && header.space_dimension == 3) linear.col(2).setZero();
  grid.origin = header.origin;
  grid.space = header.space;
  linear.row(0) *= header.flip_x;
  grid.origin(0) *= header.flip_x;
  set_axes(grid, linear, name);
}

}  // namespace

RawVolume parse_nrrd(std::string bytes, const std::string& path) {
  const NrrdHeader header = parse_nrrd_header(bytes, display_name(path));
  RawVolume raw;
  raw.layout.type = header.type;
  raw.order = header.order;
  set_shape(header.axes, header, raw.layout, display_name(path));
  load_raw_data(raw, header.data, std::move(bytes), path);
  return raw;
}

FileParts format_nrrd(const VolumeLayout& layout, const std::string& samples) {
  const Grid& grid = layout.grid;
  const int space_axes = grid.space == Space::unknown ? grid.axes : 3;
  std::string sizes, directions, kinds, spacings;
  const auto add_axis = [&](Index size, const std::string& direction, std::string_view kind, double spacing) {
    sizes += " " + std::to_string(size);
    directions += " " + direction;
    kinds += " " + std::string(kind);
    spacings += ' ';
    append_number(spacings, spacing);
  };
  const auto vector = [&](const Point<3>& v) {
    std::string text = "(";
    for (int i = 0; i < space_axes; ++i) {
      append_number(text, v(i));
      text += i + 1 < space_axes ? "," : ")";
    }
    return text;
  };
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  if (layout.components > 1)
    add_axis(layout.components, "none", layout.components == 3 ? "3-vector" : "vector", unknown);
  for (int axis = 0; axis < grid.axes; ++axis)
    add_axis(grid.size[axis], vector(grid.direction.col(axis) * grid.spacing(axis)), "domain", unknown);
  if (layout.frames > 1) add_axis(layout.frames, "none", "time", layout.time_step);
  const int axes = grid.axes + (layout.components > 1 ? 1 : 0) + (layout.frames > 1 ? 1 : 0);
  std::string head =
      "NRRD0005\ntype: " + std::string(nrrd_type_name(layout.type)) + "\ndimension: " + std::to_string(axes) + "\n";
  if (grid.space == Space::unknown)
    head += "space dimension: " + std::to_string(space_axes) + "\n";
  else
    head += std::string("space: ") +
            (grid.space == Space::left_posterior_superior ? "left-posterior-superior" : "right-anterior-superior") +
            "\n";
  head += "sizes:" + sizes + "\nspace directions:" + directions + "\nkinds:" + kinds + "\n";
  if (layout.frames > 1 && layout.time_step != 1) head += "spacings:" + spacings + "\n";
  head += "endian: little\nencoding: gzip\nspace origin: " + vector(grid.origin) + "\n\n";
  return {std::move(head), deflate_bytes({samples}, DeflateFormat::gzip)};
}

}  // namespace csrbf
