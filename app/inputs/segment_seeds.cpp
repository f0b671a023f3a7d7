#include "inputs/segment_seeds.hpp"

#include "csrbf/core/joined.hpp"
#include "csrbf/io/files/text.hpp"
#include "csrbf/io/samples.hpp"
#include "csrbf/io/volume.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numeric>
#include <optional>

namespace csrbf::app {

template <int Dim>
std::string extent_text(const Grid& grid) {
  Box<3> box;
  for (int corner = 0; corner < 8; ++corner) {
    Point<3> p;
    for (int a = 0; a < 3; ++a) p[a] = (corner >> a & 1) != 0 ? static_cast<double>(grid.size[a]) - 0.5 : -0.5;
    box.add(Point<3>(grid.to_physical<3>() * p));
  }
  std::string text;
  for (int a = 0; a < Dim; ++a)
    text += std::string(a > 0 ? ", " : "") + "xyz"[a] + " from " + rounded(box.lo[a]) + " to " + rounded(box.hi[a]);
  return text;
}

template std::string extent_text<2>(const Grid&);
template std::string extent_text<3>(const Grid&);

void require_same_place(const std::string& flag, const std::string& path, const Grid& given, const Grid& image) {
  if (given.space == Space::unknown || image.space == Space::unknown || distance_apart(given, image) == 0) return;
  throw UsageError(flag + " " + path + ": its voxels are not where those of the image are: " +
                   places_text(given, image) + "; resample it to the image");
}

namespace {

std::uint8_t label_of(double value, const std::string& path) {
  constexpr double most = 16;  // regions
  if (value != std::floor(value) || value < 0 || value > most)
    throw UsageError("--seeds " + path + ": " + rounded(value) +
                     " is no label; 1 marks label 0 of the result, 2 label 1, up to 16; 0 nothing");
  return static_cast<std::uint8_t>(value);
}

void check_confidence(const std::string& what, double p) {
  if (!(p >= 0 && p <= 1))
    throw UsageError(what + ": " + rounded(p) + " is no confidence; expected probabilities, from 0 to 1");
}

// One value for each voxel.
std::vector<float> voxel_values(const std::string& flag, const std::string& path, const Grid& grid) {
  Volume<float> image = read_volume(path);
  if (image.components != 1 || image.frames != 1 || image.grid.size != grid.size)
    throw UsageError(flag + " " + path + ": expected one value for each of " + size_text(grid) + " voxels, it has " +
                     size_text(image.grid));
  require_same_place(flag, path, image.grid, grid);
  return std::move(image.values);
}

template <int Dim>
std::size_t voxel_of(const std::string& path, const Grid& grid, const Eigen::VectorXd& point, Index i) {
  const Point<Dim> p = grid.to_voxel<Dim>() * Point<Dim>(point.head<Dim>());
  std::array<Index, 3> at{0, 0, 0};
  for (int a = 0; a < Dim; ++a) {
    at[static_cast<std::size_t>(a)] = std::lround(p[a]);
    if (!(p[a] > -0.5 && p[a] < static_cast<double>(grid.size[static_cast<std::size_t>(a)]) - 0.5))
      throw UsageError("--seeds " + path + ": point " + std::to_string(i + 1) + " is outside the image, which has " +
                       extent_text<Dim>(grid));
  }
  return static_cast<std::size_t>(grid.index(at[0], at[1], at[2]));
}

// Columns of a table of seeds, by number.
struct SeedColumns {
  std::vector<std::size_t> place;  // as many as axes
  std::size_t label = 0;
  std::optional<std::size_t> confidence;
};

// By the names x, y and z, and label and confidence, of the columns; in that order where there are others.
template <int Dim>
SeedColumns seed_columns(const std::string& path, std::vector<std::string> names) {
  const auto refuse = [&] {
    throw UsageError("--seeds " + path + ": expected the columns " + (Dim == 3 ? "x, y, z" : "x, y") +
                     ", a label and perhaps a confidence; it has " + joined(names));
  };
  if (names.size() != Dim + 1 && names.size() != Dim + 2) refuse();
  std::vector<std::string> unnamed = default_coordinate_names(std::ssize(names) - 1);
  unnamed.push_back(default_value_names(1).front());
  if (names == unnamed) names.assign(names.size(), "");  // the file has no names
  std::vector<std::size_t> rest(names.size());
  std::iota(rest.begin(), rest.end(), std::size_t{0});
  for (std::string& name : names)
    std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
  const auto take = [&](const std::string& name) {
    const auto found =
        std::find_if(rest.begin(), rest.end(), [&](std::size_t column) { return names[column] == name; });
    std::optional<std::size_t> column;
    if (found == rest.end()) return column;
    column = *found;
    rest.erase(found);
    return column;
  };
  SeedColumns columns;
  for (const char* axis : {"x", "y", "z"})
    if (const auto column = take(axis)) columns.place.push_back(*column);
  if (columns.place.empty()) {
    columns.place.assign(rest.begin(), rest.begin() + Dim);
    rest.erase(rest.begin(), rest.begin() + Dim);
  }
  if (columns.place.size() != Dim) refuse();
  const auto label = take("label");
  columns.confidence = take("confidence");
  if (!label && rest.empty()) refuse();
  columns.label = label ? *label : rest.front();
  if (!label) rest.erase(rest.begin());
  if (!columns.confidence && !rest.empty()) columns.confidence = rest.front();
  return columns;
}

template <int Dim>
void read_table(const std::string& path, const Grid& grid, SegmentOptions& options) {
  const SampleTable table = read_samples(path);
  std::vector<std::string> names = table.coordinate_names;
  names.insert(names.end(), table.value_names.begin(), table.value_names.end());
  const SeedColumns columns = seed_columns<Dim>(path, names);
  Eigen::MatrixXd numbers(std::ssize(names), table.coordinates.cols());
  numbers << table.coordinates, table.values.transpose();
  options.seeds.assign(static_cast<std::size_t>(grid.voxels()), 0);
  if (columns.confidence) options.seed_confidences.assign(options.seeds.size(), 1.0F);
  for (Index i = 0; i < numbers.cols(); ++i) {
    Eigen::VectorXd place(Dim);
    for (int a = 0; a < Dim; ++a) place[a] = numbers(static_cast<Index>(columns.place[static_cast<std::size_t>(a)]), i);
    const std::size_t voxel = voxel_of<Dim>(path, grid, place, i);
    const std::uint8_t label = label_of(numbers(static_cast<Index>(columns.label), i), path);
    if (options.seeds[voxel] != 0 && options.seeds[voxel] != label)
      throw UsageError("--seeds " + path + ": point " + std::to_string(i + 1) +
                       " and one before it give the same voxel different labels");
    options.seeds[voxel] = label;
    if (!columns.confidence) continue;
    const double confidence = numbers(static_cast<Index>(*columns.confidence), i);
    check_confidence("--seeds " + path, confidence);
    options.seed_confidences[voxel] = static_cast<float>(confidence);
  }
}

// A number or an image.
void read_confidence(const std::string& given, const Grid& grid, SegmentOptions& options) {
  const char* flag = "--seed-confidence";
  if (!options.seed_confidences.empty())
    throw UsageError(std::string(flag) + " " + given + ": the table of --seeds has confidences of its own");
  if (parse_number(given) || !is_readable_volume(given)) {
    options.seed_confidence = parse_numbers(given, ',', 1, flag)[0];
    check_confidence(flag, options.seed_confidence);
    return;
  }
  options.seed_confidences = voxel_values(flag, given, grid);
  for (std::size_t i = 0; i < options.seeds.size(); ++i)
    if (options.seeds[i] != 0) check_confidence(flag + (" " + given), static_cast<double>(options.seed_confidences[i]));
}

}  // namespace

template <int Dim>
void read_seeds(const std::string& path, const std::string& confidence, const Grid& grid, SegmentOptions& options) {
  if (is_readable_volume(path)) {
    const std::vector<float> values = voxel_values("--seeds", path, grid);
    options.seeds.reserve(values.size());
    for (const float value : values) options.seeds.push_back(label_of(static_cast<double>(value), path));
  } else {
    read_table<Dim>(path, grid, options);
  }
  if (!confidence.empty() && confidence != "1") read_confidence(confidence, grid, options);
}

template void read_seeds<2>(const std::string&, const std::string&, const Grid&, SegmentOptions&);
template void read_seeds<3>(const std::string&, const std::string&, const Grid&, SegmentOptions&);

}  // namespace csrbf::app
