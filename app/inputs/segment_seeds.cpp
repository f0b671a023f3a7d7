#include "inputs/segment_seeds.hpp"

#include "csrbf/io/samples.hpp"
#include "csrbf/io/volume.hpp"

#include <Eigen/Geometry>

#include <cmath>

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

template <int Dim>
void read_table(const std::string& path, const Grid& grid, SegmentOptions& options) {
  // The last column is the value of a table of samples.
  const SampleTable table = read_samples(path);
  const Index columns = table.coordinates.rows() + table.values.cols();
  const bool has_confidence = columns == Dim + 2;
  if (table.values.cols() != 1 || (columns != Dim + 1 && !has_confidence))
    throw UsageError("--seeds " + path + ": expected the columns " + (Dim == 3 ? "X,Y,Z" : "X,Y") +
                     ", a label and perhaps a confidence");
  options.seeds.assign(static_cast<std::size_t>(grid.voxels()), 0);
  if (has_confidence) options.seed_confidences.assign(options.seeds.size(), 1.0F);
  for (Index i = 0; i < table.coordinates.cols(); ++i) {
    const std::size_t voxel = voxel_of<Dim>(path, grid, table.coordinates.col(i), i);
    options.seeds[voxel] = label_of(has_confidence ? table.coordinates(Dim, i) : table.values(i, 0), path);
    if (!has_confidence) continue;
    check_confidence("--seeds " + path, table.values(i, 0));
    options.seed_confidences[voxel] = static_cast<float>(table.values(i, 0));
  }
}

// A number or an image.
void read_confidence(const std::string& given, const Grid& grid, SegmentOptions& options) {
  const char* flag = "--seed-confidence";
  if (!options.seed_confidences.empty())
    throw UsageError(std::string(flag) + " " + given + ": the table of --seeds has confidences of its own");
  if (!is_volume_file(given)) {
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
  if (is_volume_file(path)) {
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
