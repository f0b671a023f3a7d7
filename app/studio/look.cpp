#include "studio/look.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/gzip_file.hpp"
#include "csrbf/io/files/npy.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/files/table.hpp"
#include "csrbf/io/files/text.hpp"
#include "csrbf/io/images/formats.hpp"
#include "csrbf/io/images/sample_codec.hpp"
#include "csrbf/io/mesh.hpp"
#include "csrbf/io/models/archive.hpp"
#include "csrbf/io/models/function_archive.hpp"
#include "csrbf/io/points.hpp"
#include "csrbf/io/volume.hpp"
#include "report/surface_view.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

namespace csrbf::app {
namespace fs = std::filesystem;
namespace {

static_assert(std::endian::native == std::endian::little, "the page takes little-endian numbers");

constexpr std::size_t alignment = 8;

void pad(std::string& bytes) {
  bytes.resize((bytes.size() + alignment - 1) / alignment * alignment, '\0');
}

constexpr const char* table_files = ".csv .txt .tsv .dat";
constexpr const char* mesh_files = ".stl .glb";
constexpr const char* picture_files = ".png .pgm .ppm";
constexpr const char* scan_columns = "x y z r g b a red green blue alpha intensity confidence quality";

std::vector<float> floats(const Eigen::VectorXd& values, const std::vector<Index>& chosen) {
  std::vector<float> result;
  result.reserve(chosen.size());
  for (const Index i : chosen) result.push_back(static_cast<float>(values[i]));
  return result;
}

// Differences from the centre, so that float suffices for coordinates of maps.
std::vector<float> relative(const Points<3>& points, const Point<3>& center, const std::vector<Index>& chosen) {
  std::vector<float> result;
  result.reserve(3 * chosen.size());
  for (const Index i : chosen)
    for (Index a = 0; a < 3; ++a) result.push_back(static_cast<float>(points(a, i) - center[a]));
  return result;
}

Json range_of(const std::vector<float>& values) {
  float lo = std::numeric_limits<float>::infinity(), hi = -lo;
  for (const float value : values) {
    if (!std::isfinite(value)) continue;
    lo = std::min(lo, value);
    hi = std::max(hi, value);
  }
  return lo <= hi ? Json{lo, hi} : Json{0, 0};
}

void add_column(Look& look, const std::string& name, const std::string& type, const std::vector<float>& values) {
  const std::string array = "column" + std::to_string(look.header["columns"].size());
  look.header["columns"].push_back({{"name", name}, {"type", type}, {"array", array}, {"range", range_of(values)}});
  look.add(array, values);
}

Box<3> finite_box(const Points<3>& points) {
  Box<3> box;
  for (const auto& p : points.colwise()) {
    if (!p.allFinite()) continue;
    box.lo = box.lo.cwiseMin(p);
    box.hi = box.hi.cwiseMax(p);
  }
  return box.empty() ? Box<3>{Point<3>::Zero(), Point<3>::Zero()} : box;
}

Look look_at(const Mesh& mesh, Index most) {
  const bool is_mesh = mesh.triangles.cols() > 0;
  const Index total = mesh.vertices.cols();
  const std::vector<Index> chosen = spread_indices(total, is_mesh ? total : most);
  const Box<3> box = finite_box(mesh.vertices);
  Look look;
  look.header = {{"kind", is_mesh ? "mesh" : "points"}, {"total", total}, {"columns", Json::array()}};
  look.header["low"] = {box.lo.x(), box.lo.y(), box.lo.z()};
  look.header["high"] = {box.hi.x(), box.hi.y(), box.hi.z()};
  look.add("positions", relative(mesh.vertices, box.center(), chosen));
  if (mesh.normals.cols() == total && total > 0) look.add("normals", relative(mesh.normals, Point<3>::Zero(), chosen));
  if (is_mesh) {
    const std::int32_t* corners = mesh.triangles.data();
    look.add("triangles", std::vector<std::uint32_t>(corners, corners + mesh.triangles.size()));
  }
  for (const Property& p : mesh.properties) add_column(look, p.name, p.type, floats(p.values, chosen));
  return look;
}

std::string column_name(const Table& table, Index column) {
  return column < std::ssize(table.names) ? table.names[static_cast<std::size_t>(column)] : std::to_string(column + 1);
}

// How a table is written.
Json table_header(const Table& table) {
  Json names = Json::array();
  for (Index c = 0; c < table.values.rows(); ++c) names.push_back(column_name(table, c));
  return {{"names", names},
          {"separator", std::string(1, table.separator)},
          {"firstLine", table.first_line},
          {"namesInComment", table.names_from_comment}};
}

// Columns of a table as they are; which of them are coordinates is chosen on the page.
Look look_at(const Table& table, Index most) {
  Look look;
  look.header = table_header(table);
  look.header.update({{"kind", "table"}, {"total", table.values.cols()}, {"columns", Json::array()}});
  const std::vector<Index> chosen = spread_indices(table.values.cols(), most);
  for (Index c = 0; c < table.values.rows(); ++c)
    add_column(look, column_name(table, c), "float", floats(table.values.row(c), chosen));
  return look;
}

Look look_at(const Volume<float>& image) {
  Look look;
  const Grid& grid = image.grid;
  look.header = {{"kind", grid.dimension() == 3 ? "volume" : "image"},
                 {"total", grid.voxels()},
                 {"columns", Json::array()},
                 {"size", grid.size},
                 {"spacing", {grid.spacing.x(), grid.spacing.y(), grid.spacing.z()}},
                 {"origin", {grid.origin.x(), grid.origin.y(), grid.origin.z()}},
                 {"components", image.components},
                 {"frames", image.frames},
                 {"type", sample_name(image.type)},
                 {"range", range_of(image.values)}};
  for (Index r = 0; r < 3; ++r)
    for (Index c = 0; c < 3; ++c) look.header["direction"].push_back(grid.direction(r, c));
  if (grid.space != Space::unknown) {
    look.header["unit"] = "mm";
    const Eigen::Matrix3d patient = in_space(grid, Space::left_posterior_superior).direction;
    for (Index r = 0; r < 3; ++r)
      for (Index c = 0; c < 3; ++c) look.header["patient"].push_back(patient(r, c));
  }
  return look;
}

// Columns of a scan: x, y, z with normals, or with what scanners tell of a place. Others are values there, to be
// fitted.
bool names_points(const std::vector<std::string>& names) {
  std::vector<std::string> lower;
  for (const std::string& name : names) lower.push_back(lower_case(name));
  const auto has = [&](const char* name) { return std::find(lower.begin(), lower.end(), name) != lower.end(); };
  if (!has("x") || !has("y") || !has("z")) return false;
  return has("nx") || has("normal_x") || has("normalx") ||
         std::all_of(lower.begin(), lower.end(), [](const std::string& name) { return is_listed(name, scan_columns); });
}

// A table of numbers; NaN where a cell is not one.
Table read_table(const std::string& file) {
  const std::string content = read_content(file);
  if (content_extension(file) != ".npy") return parse_table(content, file, TextCells::note);
  const NpyArray array = parse_npy(content, file);
  Table table;
  const Index columns = array.shape.size() > 1 ? array.shape.back() : 1;
  table.values = Eigen::Map<const Eigen::MatrixXd>(array.values.data(), columns,
                                                   columns > 0 ? std::ssize(array.values) / columns : 0);
  return table;
}

bool is_table_of_points(const std::string& file) {
  constexpr Index most_columns = 6;  // an image may be as narrow as that, but points are more frequent
  const std::string content = read_content(file);
  std::string_view bytes = content;
  const NpyHeader header = parse_npy_header(bytes, file);
  return header.shape.size() == 2 && header.shape[1] <= most_columns && header.shape[1] > 1;
}

Look look_at_table(const std::string& file, Index most) {
  const Table table = read_table(file);
  const bool is_npy = content_extension(file) == ".npy";
  const bool is_places = is_npy ? table.values.rows() == 6 : names_points(table.names);
  if (!is_places) return look_at(table, most);
  Look look = look_at(read_mesh_or_points(file), most);
  look.header["table"] = table_header(table);
  return look;
}

}  // namespace

template <class Number>
void Look::add(const std::string& name, const char* type, const std::vector<Number>& values) {
  header["arrays"].push_back({{"name", name}, {"type", type}, {"count", values.size()}});
  arrays.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Number));
  pad(arrays);
}

std::string Look::bytes() const {
  const std::string text = header.dump(-1, ' ', false, Json::error_handler_t::replace);
  const auto size = static_cast<std::uint32_t>(text.size());
  std::string result(reinterpret_cast<const char*>(&size), sizeof size);
  result += text;
  pad(result);
  return result + arrays;
}

std::string kind_by_name(const std::string& name) {
  const std::string extension = content_extension(name);
  if (extension == ".csrbf") return "surface";
  if (is_listed(extension, table_files) || extension == ".npy") return "table";
  if (is_listed(extension, mesh_files)) return "mesh";
  if (is_listed(extension, picture_files)) return "image";
  if (is_readable_volume(name)) return "volume";
  if (is_mesh_file(name) || is_readable_point_file(name)) return "points";
  return "other";
}

Look Looker::look(const fs::path& path, Index most) {
  const std::string file = path.string(), extension = content_extension(file);
  if (extension == ".csrbf") {
    Look look;
    const Archive archive = read_archive(file);
    look.header = {{"kind", archive.kind == function_kind ? "function" : "surface"}};
    return look;
  }
  if (is_listed(extension, table_files)) return look_at_table(file, most);
  if (extension == ".npy") return is_table_of_points(file) ? look_at_table(file, most) : look_at(*image(path));
  if (is_readable_volume(file)) return look_at(*image(path));
  if (kind_by_name(file) == "other") throw IoError(file + ": not a kind of file that the studio shows");
  return look_at(read_mesh_or_points(file), most);
}

Looker::Image Looker::image(const fs::path& file) {
  constexpr std::size_t most = 4;  // images that are shown together
  const fs::file_time_type time = fs::last_write_time(file);
  const std::lock_guard lock(mutex_);
  for (auto kept = kept_.begin(); kept != kept_.end(); ++kept) {
    if (kept->file != file || kept->time != time) continue;
    kept_.splice(kept_.begin(), kept_, kept);
    return kept_.front().image;
  }
  auto image = std::make_shared<const Volume<float>>(read_volume(file.string()));
  kept_.remove_if([&](const Kept& kept) { return kept.file == file; });
  kept_.push_front({file, time, image});
  if (kept_.size() > most) kept_.pop_back();
  return image;
}

Look Looker::slice(const fs::path& file, int axis, Index index, Index frame) {
  const Image image = this->image(file);
  require(axis >= 0 && axis < 3, "slice", "axis", axis, "must be 0, 1 or 2");
  const auto& size = image->grid.size;
  require(index >= 0 && index < size[axis], "slice", "index", index, "must be a slice of the image");
  require(frame >= 0 && frame < image->frames, "slice", "frame", frame, "must be a frame of the image");
  const float* voxels = image->values.data() + frame * image->values_per_frame();
  const int u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
  const Index components = image->components;
  std::vector<float> values;
  values.reserve(static_cast<std::size_t>(size[u] * size[v] * components));
  std::array<Index, 3> at{};
  at[axis] = index;
  for (at[v] = 0; at[v] < size[v]; ++at[v])
    for (at[u] = 0; at[u] < size[u]; ++at[u]) {
      const float* voxel = voxels + components * image->grid.index(at[0], at[1], at[2]);
      values.insert(values.end(), voxel, voxel + components);
    }
  Look look;
  look.header = {{"width", size[u]}, {"height", size[v]}, {"components", components}};
  look.add("values", values);
  return look;
}

}  // namespace csrbf::app
