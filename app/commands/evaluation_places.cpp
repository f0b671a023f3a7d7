#include "commands/evaluation_places.hpp"

#include "csrbf/io/files/gzip_file.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/images/sample_codec.hpp"
#include "csrbf/io/samples.hpp"
#include "csrbf/io/volume.hpp"

#include <Eigen/Geometry>

#include <memory>

namespace csrbf::app {
namespace {

constexpr Index most_axes = 3;  // of a grid

bool is_table_file(const std::string& path) {
  const std::string extension = content_extension(path);
  return path == "-" || extension == ".csv" || extension == ".txt" || extension == ".npy";
}

Places at_points(const std::string& path, const NamedFunction& model) {
  const auto points = std::make_shared<const Eigen::MatrixXd>(read_queries(path, model.coordinate_names));
  VolumeLayout layout;
  layout.grid.size[0] = points->cols();
  return {.count = points->cols(),
          .points = [points](Index begin, Index n) -> Eigen::MatrixXd { return points->middleCols(begin, n); },
          .layout = layout};
}

// The nodes of a grid; their first `dimension` physical coordinates are the variables of the function.
Places at_nodes(const VolumeLayout& layout, Index dimension) {
  const auto nodes = [grid = layout.grid, dimension](Index begin, Index n) {
    const auto map = grid.to_physical<3>();
    Eigen::MatrixXd points(dimension, n);
    for (Index k = 0; k < n; ++k) {
      const Index i = begin + k;
      const Index x = i % grid.size[0], y = i / grid.size[0] % grid.size[1], z = i / (grid.size[0] * grid.size[1]);
      const Point<3> voxel(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z));
      points.col(k) = (map * voxel).head(dimension);
    }
    return points;
  };
  Places places{.count = layout.grid.voxels(), .points = nodes, .layout = layout};
  const Grid& grid = layout.grid;
  if (grid.direction.isIdentity(0) && grid.dimension() <= dimension)
    for (Index a = 0; a < dimension; ++a) {
      const Index n = grid.size[a];
      places.axes.push_back(grid.origin[a] +
                            grid.spacing[a] * Eigen::ArrayXd::LinSpaced(n, 0, static_cast<double>(n - 1)));
    }
  return places;
}

std::array<Index, 3> parse_size(const std::string& text, Index dimension) {
  constexpr double most = 1 << 24;  // nodes along an axis; more is a typing error
  const Eigen::VectorXd numbers = parse_list(text, ',', "--grid");
  const bool whole = (numbers.array() == numbers.array().round()).all() && numbers.minCoeff() >= 1;
  if (!whole || numbers.maxCoeff() > most || (numbers.size() != 1 && numbers.size() != dimension))
    throw UsageError("--grid " + text + ": expected " + std::to_string(dimension) +
                     " whole numbers, the nodes along each axis, or one for all axes");
  std::array<Index, 3> size{1, 1, 1};
  for (Index a = 0; a < dimension; ++a) size[a] = static_cast<Index>(numbers[numbers.size() == 1 ? 0 : a]);
  return size;
}

Eigen::MatrixXd parse_bounds(const std::string& text, Index dimension) {
  if (1 + std::count(text.begin(), text.end(), ',') != dimension)
    throw UsageError("--bounds " + text + ": expected " + std::to_string(dimension) +
                     (dimension == 1 ? " range LO:HI" : " ranges LO:HI, one per axis"));
  Eigen::MatrixXd bounds(dimension, 2);
  std::string_view rest = text;
  for (Index a = 0; a < dimension; ++a) {
    const std::size_t end = std::min(rest.find(','), rest.size());
    bounds.row(a) = parse_numbers(std::string(rest.substr(0, end)), ':', 2, "--bounds " + text + ":").transpose();
    if (!(bounds(a, 0) < bounds(a, 1))) throw UsageError("--bounds " + text + ": LO must be below HI");
    rest.remove_prefix(std::min(rest.size(), end + 1));
  }
  return bounds;
}

Places on_grid(const EvaluateCommand& command, const NamedFunction& model) {
  const Index d = model.function.dimension();
  if (d > most_axes)
    throw UsageError("--grid: grids have at most 3 axes, the model has " + std::to_string(d) +
                     " variables; give --points");
  VolumeLayout layout;
  Grid& grid = layout.grid;
  grid.axes = static_cast<int>(d);
  grid.size = parse_size(command.grid, d);
  const Eigen::MatrixXd bounds = command.bounds.empty() ? model.function.bounds() : parse_bounds(command.bounds, d);
  for (Index a = 0; a < d; ++a) {
    const Index n = grid.size[a];
    const double extent = bounds(a, 1) - bounds(a, 0);
    grid.origin[a] = n > 1 ? bounds(a, 0) : bounds.row(a).mean();
    const double step = n > 1 ? extent / static_cast<double>(n - 1) : extent;
    grid.spacing[a] = step > 0 ? step : 1;
  }
  layout.type = SampleType::float64;
  Places places = at_nodes(layout, d);
  Json ranges = Json::array();
  for (Index a = 0; a < d; ++a) ranges.push_back({bounds(a, 0), bounds(a, 1)});
  places.options = {{"grid", std::vector<Index>(grid.size.begin(), grid.size.begin() + d)}, {"bounds", ranges}};
  return places;
}

Places on_image(const EvaluateCommand& command, const NamedFunction& model) {
  VolumeLayout layout = read_volume<float>(command.like);
  const Index d = model.function.dimension();
  if (d > most_axes || layout.grid.dimension() > d)
    throw UsageError("--like " + command.like + ": the image has " + std::to_string(layout.grid.dimension()) +
                     " axes, the model " + std::to_string(d) + " variables");
  layout.frames = 1;
  layout.components = 1;
  if (is_picture_file(command.output) && is_floating(layout.type) && !command.labels)
    throw UsageError("--output " + command.output + ": pictures hold whole numbers, " + command.like +
                     " does not; write .tif, .nii.gz, .nrrd or .npy");
  if (!is_picture_file(command.output) && !is_floating(layout.type)) layout.type = SampleType::float64;
  return at_nodes(layout, d);
}

}  // namespace

void check_places(const EvaluateCommand& command) {
  const int given = (command.points.empty() ? 0 : 1) + (command.grid.empty() ? 0 : 1) + (command.like.empty() ? 0 : 1);
  if (given != 1) throw UsageError("give one of --points, --grid and --like: where to evaluate");
  if (!command.bounds.empty() && command.grid.empty()) throw UsageError("--bounds needs --grid");
  const std::string& output = command.output;
  if (!command.points.empty() && !is_table_file(output))
    throw UsageError("--output " + output + ": values at points go to .csv, .txt or .npy");
  if (!is_table_file(output) && !is_volume_file(output))
    throw UsageError("--output " + output + ": unknown extension \"" + file_extension(output) +
                     "\"; values on a grid go to .npy .nii .nii.gz .nrrd .mha .mhd .vti .tif, or .csv and .txt");
  if (!command.grid.empty() && is_picture_file(output) && !command.labels)
    throw UsageError("--output " + output +
                     ": pictures hold whole numbers; write .tif, .nii.gz, .nrrd or .npy, or give "
                     "--like with a picture to take the type from");
  if (command.float32 && (command.labels || is_picture_file(output)))
    throw UsageError("--float32: labels and pictures are whole numbers; leave it out");
  if (command.float32 && (!command.points.empty() || !is_volume_file(output)))
    throw UsageError("--float32 needs --grid or --like, and an image file as output, such as .npy or .nii.gz");
}

Places make_places(const EvaluateCommand& command, const NamedFunction& model) {
  if (!command.points.empty()) return at_points(command.points, model);
  Places places = command.grid.empty() ? on_image(command, model) : on_grid(command, model);
  places.is_image = is_volume_file(command.output);
  if (command.labels) places.layout.type = SampleType::uint8;
  if (command.float32) places.layout.type = SampleType::float32;
  return places;
}

}  // namespace csrbf::app
