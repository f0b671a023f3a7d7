#include "commands/evaluate/places.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/joined.hpp"
#include "csrbf/io/files/gzip_file.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/gdal/gdal.hpp"
#include "csrbf/io/images/sample_codec.hpp"
#include "csrbf/io/sample_columns.hpp"
#include "csrbf/io/samples.hpp"
#include "csrbf/io/volume.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <memory>

namespace csrbf::app {
namespace {

constexpr Index most_axes = 3;  // of a grid

bool is_table_file(const std::string& path) {
  const std::string extension = content_extension(path);
  return path == "-" || extension == ".csv" || extension == ".txt" || extension == ".npy" || is_gdal_table(extension);
}

bool is_grid(const EvaluateCommand& command) {
  return !command.grid.empty() || !command.cell.empty() || !command.extent.empty();
}

// As fit refuses them: columns in the wrong order.
void check_latitudes(const std::string& path, const NamedFunction& model, const Eigen::MatrixXd& points) {
  const std::vector<int>& sphere = model.function.report().sphere;
  if (sphere.empty()) return;
  for (const double latitude : points.row(sphere[1]))
    if (std::abs(latitude) > 90)
      throw IoError(path + ": the latitude " + rounded(latitude) +
                    " is beyond 90 degrees; the coordinates of the model are " + joined(model.coordinate_names) +
                    ", in this order where the columns have other names");
}

// Maps run from west to east along their first axis.
void check_map_axes(const EvaluateCommand& command, const NamedFunction& model) {
  const std::string& path =
      is_map_file(command.output) || is_gdal_table(content_extension(command.output)) ? command.output : command.like;
  if (!is_map_file(path) && !is_gdal_table(content_extension(path))) return;
  const std::vector<std::string>& names = model.coordinate_names;
  const std::vector<int>& sphere = model.function.report().sphere;
  const bool starts_northward =
      sphere.size() == 2 ? sphere[0] > sphere[1] : names.size() > 1 && is_northward(names[0]) && is_eastward(names[1]);
  if (starts_northward)
    throw UsageError(path + ": maps run from west to east along their first axis, which is " + names[0] +
                     " in the model; fit with --coordinates " + names[1] + "," + names[0] +
                     (names.size() > 2 ? ",..." : "") + ", or rename the columns where " + names[0] + " points east");
}

Places at_points(const std::string& path, const NamedFunction& model, Session& session) {
  Queries queries = read_queries(path, model.coordinate_names);
  if (!queries.warning.empty()) session.warn(queries.warning);
  check_latitudes(path, model, queries.coordinates);
  const auto points = std::make_shared<const Eigen::MatrixXd>(std::move(queries.coordinates));
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
  // On maps the rows go from north to south.
  places.rows_turn = dimension == 2 && grid.direction == Eigen::Vector3d(1, -1, 1).asDiagonal().toDenseMatrix();
  if ((grid.direction.isIdentity(0) || places.rows_turn) && grid.dimension() <= dimension)
    for (Index a = 0; a < dimension; ++a) {
      const Index n = grid.size[a];
      const double length = grid.spacing[a] * static_cast<double>(n - 1);
      const double first = places.rows_turn && a == 1 ? grid.origin[a] - length : grid.origin[a];
      places.axes.push_back(first + grid.spacing[a] * Eigen::ArrayXd::LinSpaced(n, 0, static_cast<double>(n - 1)));
    }
  else
    places.rows_turn = false;
  return places;
}

constexpr double most_nodes = 1 << 24;  // along an axis; more is a typing error

bool is_without_numbers(const std::string& grid) {
  return grid.empty() || grid == grid_without_numbers;
}

std::array<Index, 3> parse_size(const std::string& text, Index dimension) {
  if (is_without_numbers(text)) {
    constexpr std::array<Index, 3> usual{1000, 500, 100};  // along each axis, by dimension; chosen by hand
    std::array<Index, 3> size{1, 1, 1};
    std::fill_n(size.begin(), dimension, usual[static_cast<std::size_t>(dimension - 1)]);
    return size;
  }
  const auto refuse = [&] {
    constexpr std::array<const char*, 3> forms{"100", "100,50", "100,50,20"};
    throw UsageError("--grid " + text + ": expected " + std::to_string(dimension) + " whole number" +
                     (dimension > 1 ? "s, the nodes along each axis, or one for all axes" : ", the nodes") +
                     ", as --grid " + forms[static_cast<std::size_t>(dimension - 1)]);
  };
  Eigen::VectorXd numbers;
  try {
    numbers = parse_list(text, ',', "--grid");
  } catch (const UsageError&) {
    refuse();
  }
  const bool whole = (numbers.array() == numbers.array().round()).all() && numbers.minCoeff() >= 1;
  if (!whole || numbers.maxCoeff() > most_nodes || (numbers.size() != 1 && numbers.size() != dimension)) refuse();
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

// LO and HI as one corner after the other: XMIN,YMIN,XMAX,YMAX.
// `box` is that of the samples.
Eigen::MatrixXd parse_extent(const std::string& text, const Eigen::MatrixXd& box) {
  const Index dimension = box.rows();
  const Eigen::VectorXd numbers = parse_list(text, ',', "--extent");
  if (numbers.size() != 2 * dimension)
    throw UsageError("--extent " + text + ": expected " + std::to_string(2 * dimension) +
                     " numbers, the lower corner and the upper one" + (dimension == 2 ? ": XMIN,YMIN,XMAX,YMAX" : ""));
  Eigen::MatrixXd extent(dimension, 2);
  extent << numbers.head(dimension), numbers.tail(dimension);
  // XMIN,XMAX,YMIN,YMAX, as in other programs.
  const Eigen::MatrixXd pairs = numbers.reshaped<Eigen::RowMajor>(dimension, 2);
  const auto common = [&](const Eigen::MatrixXd& other) {
    return (other.col(1).cwiseMin(box.col(1)) - other.col(0).cwiseMax(box.col(0))).cwiseMax(0).prod();
  };
  const auto area = [](const Eigen::MatrixXd& other) { return (other.col(1) - other.col(0)).prod(); };
  const bool ascends = (extent.col(0).array() < extent.col(1).array()).all();
  // A tenth is chosen by hand.
  if (dimension == 2 && (pairs.col(0).array() < pairs.col(1).array()).all() && common(pairs) > 0 &&
      (!ascends || (common(pairs) >= common(extent) && area(pairs) < 0.1 * area(extent))))
    throw UsageError("--extent " + text + ": the order is XMIN,YMIN,XMAX,YMAX; the samples are in XMIN,XMAX,YMIN,YMAX");
  if (!ascends) throw UsageError("--extent " + text + ": the lower corner, with the smaller numbers, comes first");
  return extent;
}

Eigen::VectorXd parse_cell(const std::string& text, Index dimension) {
  const Eigen::VectorXd numbers = parse_list(text, ',', "--cell");
  if (!(numbers.minCoeff() > 0) || (numbers.size() != 1 && numbers.size() != dimension))
    throw UsageError("--cell " + text + ": expected a positive size, or one for each of the " +
                     std::to_string(dimension) + " axes");
  return numbers.size() == 1 ? Eigen::VectorXd::Constant(dimension, numbers[0]) : numbers;
}

// Nodes from the first to the last.
void set_axis(Grid& grid, Index a, double first, double last) {
  const Index n = grid.size[static_cast<std::size_t>(a)];
  grid.origin[a] = n > 1 ? first : (first + last) / 2;
  const double step = n > 1 ? (last - first) / static_cast<double>(n - 1) : last - first;
  grid.spacing[a] = step > 0 ? step : 1;
}

// Cells of the given size over the extent, whose upper end gives way where it is not a whole number of them; by default
// over all whole cells in which samples are. Nodes are the centres.
void set_cells(Grid& grid, const EvaluateCommand& command, const NamedFunction& model) {
  const Index d = model.function.dimension();
  const Eigen::VectorXd cell = parse_cell(command.cell, d);
  const Eigen::MatrixXd box = model.function.bounds();
  const bool has_extent = !command.extent.empty();
  Eigen::MatrixXd extent = has_extent ? parse_extent(command.extent, box) : box;
  for (Index a = 0; a < d; ++a) {
    if (!has_extent)
      extent.row(a) << std::floor(box(a, 0) / cell[a]) * cell[a], std::ceil(box(a, 1) / cell[a]) * cell[a];
    const double count = std::max(1.0, std::round((extent(a, 1) - extent(a, 0)) / cell[a]));
    if (!(count <= most_nodes))
      throw UsageError("--cell " + command.cell + ": that makes " + rounded(count) + " cells along axis " +
                       std::to_string(a + 1) + "; give a larger size");
    grid.size[static_cast<std::size_t>(a)] = static_cast<Index>(count);
    grid.spacing[a] = cell[a];
    grid.origin[a] = extent(a, 0) + cell[a] / 2;
  }
}

// Numbers of nodes over bounds or an extent.
void set_nodes(Grid& grid, const EvaluateCommand& command, const NamedFunction& model) {
  const Index d = model.function.dimension();
  grid.size = parse_size(command.grid, d);
  const bool has_extent = !command.extent.empty();
  const Eigen::MatrixXd bounds = has_extent               ? parse_extent(command.extent, model.function.bounds())
                                 : command.bounds.empty() ? model.function.bounds()
                                                          : parse_bounds(command.bounds, d);
  for (Index a = 0; a < d; ++a) {
    const double cell = (bounds(a, 1) - bounds(a, 0)) / static_cast<double>(grid.size[static_cast<std::size_t>(a)]);
    const double margin = has_extent ? cell / 2 : 0;
    set_axis(grid, a, bounds(a, 0) + margin, bounds(a, 1) - margin);
    if (has_extent) grid.spacing[a] = cell;
  }
}

Places on_grid(const EvaluateCommand& command, const NamedFunction& model) {
  const Index d = model.function.dimension();
  if (d > most_axes)
    throw UsageError("--grid: grids have at most 3 axes, the model has " + std::to_string(d) +
                     " variables; give --points");
  if (const std::vector<int>& drift = model.function.report().drift_axes; !drift.empty() && command.levels.empty())
    throw UsageError(std::string(!command.grid.empty()   ? "--grid"
                                 : !command.cell.empty() ? "--cell"
                                                         : "--extent") +
                     ": a grid does not tell the " + model.coordinate_names[static_cast<std::size_t>(drift.front())] +
                     " of its nodes, a covariate of the model; give --points with the columns " +
                     joined(model.coordinate_names) +
                     (drift == std::vector<int>{2} ? ", or --like with an image of it" : ""));
  VolumeLayout layout;
  Grid& grid = layout.grid;
  grid.axes = static_cast<int>(d);
  if (command.cell.empty())
    set_nodes(grid, command, model);
  else
    set_cells(grid, command, model);
  const auto last = [&](Index a) {
    return grid.spacing[a] * static_cast<double>(grid.size[static_cast<std::size_t>(a)] - 1);
  };
  Json ranges = Json::array();
  for (Index a = 0; a < d; ++a) ranges.push_back({grid.origin[a], grid.origin[a] + last(a)});
  if (d == 2 && is_map_file(command.output)) {
    grid.origin[1] += last(1);
    grid.direction(1, 1) = -1;
  }
  const bool is_tiff = file_extension(command.output).starts_with(".tif");
  layout.type = is_tiff ? SampleType::float32 : SampleType::float64;
  Places places = at_nodes(layout, d);
  places.options = {{"grid", std::vector<Index>(grid.size.begin(), grid.size.begin() + d)}, {"bounds", ranges}};
  return places;
}

// The third variable, a covariate such as the elevation, is the value of the image.
Places at_covariate(Volume<float> image, const VolumeLayout& layout) {
  Places places = at_nodes(layout, 2);
  places.axes.clear();
  places.rows_turn = false;
  const auto covariate = std::make_shared<const Volume<float>>(std::move(image));
  places.points = [covariate, plane = places.points](Index begin, Index n) {
    Eigen::MatrixXd points(3, n);
    points << plane(begin, n), covariate->frame().middleCols(begin, n).template cast<double>();
    return points;
  };
  return places;
}

Places on_image(const EvaluateCommand& command, const NamedFunction& model, Session& session) {
  Volume<float> image = read_volume<float>(command.like);
  VolumeLayout layout = image;
  const Index d = model.function.dimension();
  const std::vector<int>& drift = model.function.report().drift_axes;
  if (d > most_axes && drift.size() > 1)
    throw UsageError(
        "--like " + command.like + ": the model has " + std::to_string(drift.size()) +
        " covariates besides the coordinates, an image tells one at most; give --points with the columns " +
        joined(model.coordinate_names));
  if (d > most_axes || layout.grid.dimension() > d)
    throw UsageError("--like " + command.like + ": the image has " + std::to_string(layout.grid.dimension()) +
                     " axes, the model " + std::to_string(d) + " variables");
  layout.frames = 1;
  layout.components = 1;
  if (is_picture_file(command.output) && is_floating(layout.type) && !command.labels)
    throw UsageError("--output " + command.output + ": pictures hold whole numbers, " + command.like +
                     " does not; write .tif, .nii.gz, .nrrd or .npy");
  if (!is_picture_file(command.output) && !is_floating(layout.type)) layout.type = SampleType::float64;
  if (layout.grid.dimension() == d) return at_nodes(layout, d);
  if (drift.empty() && layout.crs.empty()) {
    session.say(model.coordinate_names.back() + ": 0, as " + command.like + " has no such axis");
    return at_nodes(layout, d);
  }
  if (d != 3 || drift != std::vector<int>{2} || image.components != 1)
    throw UsageError("--like " + command.like + ": it does not tell the " + model.coordinate_names.back() +
                     " of its pixels, which is a variable of the model; give --points");
  session.say(model.coordinate_names.back() + ": the values of " + command.like);
  return at_covariate(std::move(image), layout);
}

// That of the samples, or the one given. Coordinates are not transformed, so the two must agree.
std::string crs_of(const EvaluateCommand& command, const NamedFunction& model) {
  if (command.crs.empty()) return model.crs;
  const std::string& output = command.output;
  if (!is_map_file(output) && !is_gdal_table(content_extension(output)))
    throw UsageError("--crs " + command.crs + ": " + output +
                     " cannot hold a reference system; write .tif .asc .nc, or .gpkg .shp .geojson .fgb");
  std::string crs;
  try {
    crs = checked_crs(command.crs);
  } catch (const IoError& error) {
    throw UsageError("--crs " + command.crs + ": " + error.what());
  }
  if (!model.crs.empty() && model.crs != crs)
    throw UsageError("--crs " + command.crs + ": the samples are in " + model.crs +
                     ", and their coordinates are not transformed; leave it out, and transform the result");
  return crs;
}

}  // namespace

void check_grid(const EvaluateCommand& command) {
  if (!command.bounds.empty() && !is_grid(command)) throw UsageError("--bounds needs --grid");
  if (!command.bounds.empty() && !command.extent.empty())
    throw UsageError("--bounds, of the nodes, and --extent, of the cells, exclude each other");
  if (!command.cell.empty() && !is_without_numbers(command.grid))
    throw UsageError("--cell and numbers of --grid exclude each other: give --grid without numbers");
  if (!command.cell.empty() && !command.bounds.empty())
    throw UsageError("--cell goes with --extent, the outer edges of the cells, instead of --bounds");
}

void check_places(const EvaluateCommand& command) {
  const int given = (command.points.empty() ? 0 : 1) + (is_grid(command) ? 1 : 0) + (command.like.empty() ? 0 : 1);
  if (given != 1)
    throw UsageError("give one of --points, --grid and --like: where to evaluate; --cell and --extent make a grid too");
  check_grid(command);
  const std::string& output = command.output;
  if (!command.points.empty() && !is_table_file(output))
    throw UsageError("--output " + output + ": values at points go to .csv, .txt, .npy, .gpkg, .shp, .geojson or .fgb");
  if (!is_table_file(output) && !is_volume_file(output))
    throw UsageError(
        "--output " + output + ": unknown extension \"" + file_extension(output) +
        "\"; values on a grid go to .npy .nii .nii.gz .nrrd .mha .mhd .vti .tif .asc .nc, or .csv and .txt");
  if (is_grid(command) && is_picture_file(output) && !command.labels)
    throw UsageError("--output " + output +
                     ": pictures hold whole numbers; write .tif, .nii.gz, .nrrd or .npy, or give "
                     "--like with a picture to take the type from");
  if (command.float32 && (command.labels || is_picture_file(output)))
    throw UsageError("--float32: labels and pictures are whole numbers; leave it out");
  if (command.float32 && (!command.points.empty() || !is_volume_file(output)))
    throw UsageError("--float32 needs --grid or --like, and an image file as output, such as .npy or .nii.gz");
}

Places make_places(const EvaluateCommand& command, const NamedFunction& model, Session& session) {
  const std::string crs = crs_of(command, model);
  check_map_axes(command, model);
  if (!command.points.empty()) {
    Places places = at_points(command.points, model, session);
    places.crs = crs;
    return places;
  }
  Places places = is_grid(command) ? on_grid(command, model) : on_image(command, model, session);
  if (!crs.empty() && !places.layout.crs.empty() && crs != places.layout.crs)
    throw UsageError("--like " + command.like + ": the image is in " + places.layout.crs + ", the samples are in " +
                     crs + ", and nothing is transformed");
  if (!crs.empty()) places.layout.crs = crs;
  places.crs = places.layout.crs;
  if (!places.crs.empty()) places.options["crs"] = places.crs;
  places.is_image = is_volume_file(command.output) && !is_gdal_table(file_extension(command.output));
  if (command.labels) places.layout.type = SampleType::uint8;
  if (command.float32) places.layout.type = SampleType::float32;
  return places;
}

}  // namespace csrbf::app
