#include "commands/segment_options.hpp"

#include "commands/segment_start.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace csrbf::app {

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
  if (image.components > 1)
    refuse(
        "the image has " + std::to_string(image.components) +
        " values per pixel, such as colours or transparency; convert it to grey, or keep one channel (for example by "
        "\"convert photo.png -alpha off -colorspace gray grey.png\")");
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

void check_finite(const std::string& path, const Volume<float>& image, const std::vector<std::uint8_t>& mask) {
  for (std::size_t i = 0; i < image.values.size(); ++i) {
    if (std::isfinite(image.values[i]) || (!mask.empty() && mask[i] == 0)) continue;
    const std::string voxel = voxel_text(image.grid, static_cast<Index>(i));
    throw UsageError(path + ": voxel " + voxel + " is " + rounded(image.values[i]) +
                     "; fill such voxels with csrbf inpaint, or exclude them with --mask");
  }
}

}  // namespace csrbf::app
