#include "commands/segment_options.hpp"

#include "inputs/segment_seeds.hpp"

#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/model.hpp"
#include "csrbf/io/points.hpp"
#include "csrbf/io/samples.hpp"
#include "csrbf/io/volume.hpp"
#include "csrbf/surface/reconstruct.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <cmath>

namespace csrbf::app {
namespace {

constexpr const char* forms =
    "expected auto, sphere:X,Y[,Z],R, box:X,Y[,Z],X,Y[,Z], mask:FILE, points:FILE or MODEL.csrbf";

std::string axes_text(int dim) {
  return dim == 3 ? "X,Y,Z" : "X,Y";
}

template <int Dim>
Seed sphere(const std::string& where, const std::string& numbers, const Grid& grid) {
  if (std::count(numbers.begin(), numbers.end(), ',') != Dim)
    throw UsageError("--init " + where + ": expected sphere:" + axes_text(Dim) + ",R for an image of " +
                     std::to_string(Dim) + " axes");
  const Eigen::VectorXd n = parse_list(numbers, ',', "--init sphere:");
  if (!(n[Dim] > 0)) throw UsageError("--init " + where + ": the radius must be positive");
  return seed_ball<Dim>(grid, n.head<Dim>(), n[Dim]);
}

template <int Dim>
Seed box(const std::string& flag, const std::string& where, const Grid& grid) {
  const std::string numbers = where.substr(where.find(':') + 1);
  if (std::count(numbers.begin(), numbers.end(), ',') != 2 * Dim - 1)
    throw UsageError(flag + " " + where + ": expected box:" + axes_text(Dim) + "," + axes_text(Dim) +
                     ", two opposite corners, for an image of " + std::to_string(Dim) + " axes");
  const Eigen::VectorXd n = parse_list(numbers, ',', flag + " box:");
  Box<Dim> corners;
  corners.add(Point<Dim>(n.head<Dim>()));
  corners.add(Point<Dim>(n.tail<Dim>()));
  return seed_box<Dim>(grid, corners);
}

template <int Dim>
Seed around(const std::string& where, const std::string& path, const Grid& grid, const Progress& progress) {
  const auto too_few = [&](Index n) {
    throw UsageError("--init " + where + ": " + std::to_string(n) + " points are too few; at least " +
                     (Dim == 2 ? "3 are needed" : "4, better 20 spread over the whole boundary, are needed"));
  };
  if constexpr (Dim == 2) {
    const Points<2> points = read_queries(path, {"x", "y"}).coordinates;
    if (points.cols() < 3) too_few(points.cols());
    return seed_polygon(grid, points);
  } else {
    const PointCloud cloud = read_points(path);
    if (cloud.size() < 4) too_few(cloud.size());
    const Reconstruction surface = reconstruct(cloud, {.progress = progress});
    return seed_inside<3>(grid, *surface.field);
  }
}

template <int Dim>
Seed inside_model(const std::string& path, const Grid& grid) {
  if constexpr (Dim == 3) {
    return seed_inside<3>(grid, *read_model(path));
  } else {
    const Function function = read_function(path).function;
    if (function.dimension() != Dim || function.components() != 1)
      throw UsageError("--init " + path + ": the model has " + std::to_string(function.dimension()) +
                       " variables and " + counted(function.components(), "component") + "; expected " +
                       std::to_string(Dim) + " variables and 1 component");
    return seed_inside<Dim>(grid, *function.fit<Dim>().components.front());
  }
}

}  // namespace

SegmentOptions make_segment_options(const SegmentFlags& flags) {
  SegmentOptions options;
  options.energy = segment_energy(flags.energy);
  options.mode = segment_mode(flags.mode);
  options.method = segment_method(flags.method);
  options.regions = flags.regions;
  options.center_spacing = flags.center_spacing;
  options.support = flags.support;
  options.kernel = flags.kernel;
  options.smoothness = parse_word_or_number(flags.smoothness, "auto", "--smoothness");
  options.window = flags.window;
  options.shading = shading_named(flags.shading);
  options.balloon = flags.balloon;
  if (flags.fill_holes != "auto") options.fill_holes = flags.fill_holes == "yes";
  options.iterations = flags.iterations;
  if (options.energy == SegmentEnergy::edge && flags.init == "auto")
    throw UsageError("--energy edge: a contour on edges needs a start: give --init");
  return options;
}

void add_segment_options(const SegmentFlags& flags, const SegmentSettings& used, Session& session) {
  session.options.update({{"energy", name_of(used.energy)},
                          {"init", flags.init},
                          {"regions", used.regions},
                          {"center_spacing", or_null(used.center_spacing)},
                          {"support", or_null(used.support)},
                          {"kernel", used.kernel},
                          {"smoothness", used.smoothness.value_or(0)},
                          {"window", used.window.value_or(0)},
                          {"shading", name_of(used.shading)},
                          {"balloon", used.balloon},
                          {"fill_holes", used.fill_holes.value_or(false)},
                          {"mask", or_null(flags.mask)},
                          {"mode", name_of(used.mode)},
                          {"method", name_of(used.method)},
                          {"iterations", used.iterations}});
}

void check_image(const std::string& path, const Volume<float>& image) {
  const auto refuse = [&](const std::string& what) { throw UsageError(path + ": " + what); };
  if (image.frames > 1)
    refuse("the image has " + std::to_string(image.frames) +
           " frames; segment takes one: save one frame, or segment all of them with csrbf track");
  if (std::all_of(image.values.begin(), image.values.end(), [&](float value) { return value == image.values[0]; }))
    refuse("all voxels have the value " + rounded(image.values[0]) + ": there is nothing to segment");
  const Grid& grid = image.grid;
  const int dimension = grid.dimension();
  for (int a = 0; a < dimension; ++a)
    if (grid.size[a] < 2)
      refuse("the image has one voxel along " + std::string(1, "xyz"[a]) + " (" + size_text(grid) +
             "); a slice must be thin along its last axis: reorder the axes, or write the slice as a plane image");
  if (dimension < 2) refuse("the image has one axis only (" + size_text(grid) + "); segment needs two or three");
  if (dimension == 2 && std::abs(grid.direction.topLeftCorner<2, 2>().determinant()) < 1e-6)
    refuse(
        "the slice does not span the first two axes of space; save it without its position (.npy, .tif), or reorder "
        "the axes of space");
}

void refuse_voxel(const std::string& path, const Grid& grid, Index voxel, float value) {
  throw UsageError(path + ": voxel " + voxel_text(grid, voxel) + " is " + rounded(static_cast<double>(value)) +
                   "; fill such voxels with csrbf inpaint, or exclude them with --mask");
}

void check_finite(const std::string& path, const Volume<float>& image, const std::vector<std::uint8_t>& mask) {
  const auto voxel_at = [&](std::size_t i) { return static_cast<Index>(i) / image.components; };
  for (std::size_t i = 0; i < image.values.size(); ++i) {
    if (std::isfinite(image.values[i]) || (!mask.empty() && mask[voxel_at(i)] == 0)) continue;
    refuse_voxel(path, image.grid, voxel_at(i), image.values[i]);
  }
}

std::vector<std::uint8_t> read_voxels(const std::string& flag, const std::string& path, const Grid& grid) {
  const Volume<float> image = read_volume(path);
  if (image.components != 1 || image.frames != 1)
    throw UsageError(flag + " " + path + ": expected one value per voxel and one frame");
  if (image.grid.size != grid.size)
    throw UsageError(flag + " " + path + ": it has " + size_text(image.grid) + " voxels, the image " + size_text(grid));
  require_same_place(flag, path, image.grid, grid);
  std::vector<std::uint8_t> voxels(image.values.size());
  for (std::size_t i = 0; i < voxels.size(); ++i) voxels[i] = std::abs(image.values[i]) > 0 ? 1 : 0;
  return voxels;
}

Volume<float> label_image(const VolumeLayout& layout, const std::vector<std::uint8_t>& labels,
                          std::vector<float> memory) {
  Volume<float> image;
  static_cast<VolumeLayout&>(image) = layout;
  image.type = SampleType::uint8;
  image.components = 1;
  image.values = std::move(memory);
  image.values.assign(labels.begin(), labels.end());
  return image;
}

template <int Dim>
Seed read_seed(const std::string& where, const Grid& grid, const Progress& progress) {
  if (where == "auto") return {};
  const std::size_t colon = where.find(':');
  const std::string form = where.substr(0, colon);
  const std::string rest = colon == std::string::npos ? "" : where.substr(colon + 1);
  Seed seed;
  if (form == "sphere")
    seed = sphere<Dim>(where, rest, grid);
  else if (form == "box")
    seed = box<Dim>("--init", where, grid);
  else if (form == "mask")
    seed = read_voxels("--init mask:", rest, grid);
  else if (form == "points")
    seed = around<Dim>(where, rest, grid, progress);
  else if (file_extension(where) == ".csrbf")
    seed = inside_model<Dim>(where, grid);
  else
    throw UsageError("--init " + where + ": " + forms);
  if (std::find(seed.begin(), seed.end(), 1) == seed.end())
    throw UsageError("--init " + where + ": covers no voxel of the image, which has " + extent_text<Dim>(grid));
  return seed;
}

template <int Dim>
std::vector<std::uint8_t> read_mask(const std::string& where, const Grid& grid) {
  if (!where.starts_with("box:")) return read_voxels("--mask", where, grid);
  Seed mask = box<Dim>("--mask", where, grid);
  if (std::find(mask.begin(), mask.end(), 1) == mask.end())
    throw UsageError("--mask " + where + ": covers no voxel of the image, which has " + extent_text<Dim>(grid));
  return mask;
}

template std::vector<std::uint8_t> read_mask<2>(const std::string&, const Grid&);
template std::vector<std::uint8_t> read_mask<3>(const std::string&, const Grid&);

template Seed read_seed<2>(const std::string&, const Grid&, const Progress&);
template Seed read_seed<3>(const std::string&, const Grid&, const Progress&);

}  // namespace csrbf::app
