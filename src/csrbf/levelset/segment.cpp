#include "csrbf/levelset/segment.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/levelset/edge_flow.hpp"
#include "csrbf/levelset/region_cores.hpp"
#include "csrbf/levelset/region_forces.hpp"
#include "csrbf/levelset/region_labels.hpp"
#include "csrbf/levelset/segment_baselines.hpp"
#include "csrbf/levelset/segment_fields.hpp"
#include "csrbf/levelset/speckle_contour.hpp"
#include "csrbf/levelset/variational.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

namespace csrbf {
namespace {

constexpr const char* here = "segment";

void check_options(const SegmentOptions& options) {
  require(options.regions >= 2 && options.regions <= 16, here, "regions", options.regions, "must be 2 to 16");
  require(options.iterations > 0, here, "iterations", options.iterations, "must be positive");
  if (options.smoothness)
    require(*options.smoothness >= 0 && std::isfinite(*options.smoothness), here, "smoothness", *options.smoothness,
            "must not be negative");
  if (options.window)
    require(*options.window >= 0 && *options.window <= 1000, here, "window", *options.window, "must be 0 to 1000");
  require(options.balloon >= -1 && options.balloon <= 1, here, "balloon", options.balloon, "must be in [-1, 1]");
  if (options.regions > 2) {
    require(options.mode == SegmentMode::global && options.method == SegmentMethod::variational, here, "regions",
            options.regions, "more than two need the mode global and the method variational");
    require(options.energy != SegmentEnergy::edge && !options.force, here, "regions", options.regions,
            "more than two need an energy of intensities");
    require(options.seed.empty() && options.start.empty() && options.prior.empty(), here, "regions", options.regions,
            "seed, start and prior are for two regions");
  }
  if (options.method != SegmentMethod::variational)
    require(options.energy != SegmentEnergy::edge || options.force, here, "energy", "edge",
            "needs the method variational");
  if (options.energy == SegmentEnergy::edge && !options.force)
    require(!options.seed.empty(), here, "energy", "edge", "needs a seed to start from (init)");
}

// Beyond half the image centres tell nothing apart; stencils for all places of a voxel between them take S^Dim memory.
template <int Dim>
void check_center_spacing(const Grid& grid, double center_spacing) {
  constexpr double most = Dim == 2 ? 256 : 40;
  const auto sides = Eigen::Map<const Eigen::Array<Index, 3, 1>>(grid.size.data()).head<Dim>().template cast<double>();
  const auto edges = grid.spacing.head<Dim>().array();
  const double half = std::floor((sides * edges).maxCoeff() / edges.minCoeff() / 2);
  const double largest = std::clamp(half, 1.0, most);
  std::ostringstream constraint;
  constraint << "must be at most " << largest << " voxels for this image"
             << (half <= most ? ", half its longest side" : "") << "; leave it out to have it chosen";
  require(center_spacing <= largest, here, "center_spacing", center_spacing, constraint.str());
}

template <int Dim>
void check_image(const Volume<float>& image, const SegmentOptions& options) {
  const Grid& grid = image.grid;
  const auto voxels = static_cast<std::size_t>(grid.voxels());
  require(image.components == 1, here, "components", image.components, "the image must have one value per voxel");
  require(image.frames == 1, here, "frames", image.frames, "the image must have one frame; track() takes sequences");
  require(image.values.size() == voxels, here, "number of values", image.values.size(), "must be that of the voxels");
  for (std::size_t a = 0; a < 3; ++a)
    require(a < Dim ? grid.size[a] >= 2 : grid.size[a] == 1, here, "size", grid.size[a],
            a < Dim ? "the image must have at least 2 voxels along each axis" : "the image has too many axes");
  if (options.center_spacing) check_center_spacing<Dim>(grid, *options.center_spacing);
  const auto check_array = [&](const std::vector<std::uint8_t>& array, const char* name) {
    if (array.empty()) return;
    require(array.size() == voxels, here, std::string(name) + " size", array.size(),
            "must be the number of voxels, " + std::to_string(voxels));
    bool any = false;
    for (std::size_t i = 0; i < voxels && !any; ++i)
      any = array[i] != 0 && (options.mask.empty() || options.mask.size() != voxels || options.mask[i] != 0);
    require(
        any, here, name, "empty",
        std::string(name) == "mask" ? "must be set in some voxels" : "must have voxels inside the image and its mask");
  };
  check_array(options.mask, "mask");
  check_array(options.seed, "seed");
  check_array(options.start, "start");
  require(options.prior.empty() || options.prior.size() == voxels, here, "prior size", options.prior.size(),
          "must be the number of voxels, " + std::to_string(voxels));
}

// The values, with numbers in place of NaN outside the mask.
std::vector<float> finite_values(const Volume<float>& image, const std::vector<std::uint8_t>& mask) {
  std::vector<float> values;
  for (std::size_t i = 0; i < image.values.size(); ++i) {
    if (std::isfinite(image.values[i])) continue;
    require(!mask.empty() && mask[i] == 0, here, "image", image.values[i],
            "not a number in voxel " + voxel_text(image.grid, static_cast<Index>(i)) +
                "; fill such voxels with inpaint() or leave them out by a mask");
    if (values.empty()) values = image.values;
    values[i] = 0;
  }
  return values;
}

IntensityLaw law_of(SegmentEnergy energy) {
  switch (energy) {
    case SegmentEnergy::gaussian:
      return IntensityLaw::gaussian;
    case SegmentEnergy::generalized_gaussian:
      return IntensityLaw::generalized_gaussian;
    case SegmentEnergy::rayleigh:
      return IntensityLaw::rayleigh;
    case SegmentEnergy::gamma:
      return IntensityLaw::gamma;
    default:
      return IntensityLaw::chan_vese;
  }
}

// The options with values in place of `automatic`, but for the center spacing and the shading.
SegmentOptions choose_options(SegmentOptions options) {
  const bool edge = options.energy == SegmentEnergy::edge && !options.force;
  if (edge) options.mode = SegmentMode::local;
  const bool smooth_by_centers = !options.smoothness || *options.smoothness > 0;
  if (!options.center_spacing && !smooth_by_centers) options.center_spacing = 1;
  if (!options.smoothness) options.smoothness = edge ? 1 : 0;
  if (!options.support) options.support = options.method == SegmentMethod::collocation ? 4 : 2.5;
  if (!options.fill_holes) options.fill_holes = options.mode == SegmentMode::local;
  return options;
}

// About 50 voxels of their own noise tell two textures apart; centers then smooth on.
int choose_window(const SegmentOptions& options, const ForceNoise& noise, int dimension) {
  if (options.energy != SegmentEnergy::generalized_gaussian || options.force) return 0;
  return static_cast<int>(std::lround((dimension == 2 ? 3 : 1) * noise.grain));
}

void check_contrast(std::span<const float> values, const std::vector<std::uint8_t>& mask) {
  const auto takes_part = [&](std::size_t i) { return mask.empty() || mask[i] != 0; };
  std::size_t first = 0;
  while (!takes_part(first)) ++first;
  bool constant = true;
  for (std::size_t i = first; i < values.size() && constant; ++i)
    constant = !takes_part(i) || values[i] == values[first];
  require(!constant, here, "image", values[first], "a constant image has no regions to tell apart");
}

template <int Dim>
ForceSource intensity_source(RegionForces<Dim>& forces, int regions) {
  auto before = std::make_shared<typename RegionForces<Dim>::State>();
  return {regions,
          [&forces, before](std::span<const std::uint8_t> labels) {
            *before = forces.state();
            forces.fit(labels);
            return true;
          },
          [&forces, before] { forces.set_state(*before); },
          [&forces](int k, double scale, std::span<float> force) { return forces.force(k, scale, force); },
          {}};
}

// What the caller says. The force depends on labels, so it is taken anew with each estimate.
ForceSource custom_source(const SegmentOptions& options) {
  struct Forces {
    std::vector<std::uint8_t> labels, before;
  };
  auto state = std::make_shared<Forces>();
  return {2,
          [state](std::span<const std::uint8_t> labels) {
            state->before = std::exchange(state->labels, {labels.begin(), labels.end()});
            return true;
          },
          [state] { state->labels = state->before; },
          [state, &options](int, double scale, std::span<float> force) {
            options.force(state->labels.data(), force.data());
            double outside = 0;  // the smaller cost of each voxel is 0
            for (std::size_t i = 0; i < force.size(); ++i) {
              require(std::isfinite(force[i]), here, "force", force[i], "the function must write finite numbers");
              force[i] = options.mask.empty() || options.mask[i] != 0 ? static_cast<float>(force[i] / scale) : 0.0F;
              outside += std::max(0.0, -static_cast<double>(force[i]) * scale);
            }
            return outside;
          },
          {}};
}

ForceNoise measure_noise(const ForceSource& source, const std::vector<std::uint8_t>& labels,
                         const std::vector<std::uint8_t>& mask, const Grid& grid) {
  ForceNoise noise;
  std::vector<float> force(labels.size());
  std::vector<std::uint8_t> is_k(labels.size());
  for (int k = source.regions == 2 ? 1 : 0; k < source.regions; ++k) {
    source.force(k, 1, force);
    for (std::size_t i = 0; i < labels.size(); ++i) is_k[i] = labels[i] == k ? 1 : 0;
    const ForceNoise found = force_noise(force, is_k, mask, grid);
    noise = {std::max(noise.size, found.size), std::max(noise.grain, found.grain)};
  }
  return noise;
}

bool can_be_shaded(const SegmentOptions& options) {
  return !options.force && options.shading != Shading::none &&
         (options.energy == SegmentEnergy::chan_vese || options.energy == SegmentEnergy::gaussian);
}

// Lets the means vary and goes on, if that is wanted or explains most of what constants leave.
template <int Dim>
void shade(const Lattice<Dim>& lattice, RegionForces<Dim>& forces, const ForceSource& source, double noise,
           SegmentOptions& used, VariationalResult& result) {
  constexpr double clearly = 0.5;
  if (used.shading == Shading::automatic)
    used.shading = forces.shading_explains(result.labels) > clearly ? Shading::linear : Shading::none;
  if (used.shading == Shading::none) return;
  forces.set_shading_degree(used.shading == Shading::linear ? 1 : 2);
  forces.fit(result.labels);
  result = descend_globally(lattice, source, used, noise, std::move(result.labels));
}

// Makes the region that must be inside label 1, or brings the labels of several in order.
void choose_polarity(const Grid& grid, const SegmentOptions& options, VariationalResult& result) {
  int outside = -1;
  if (!options.seed.empty()) {
    const int inside = seeded_region(result.labels, options.seed, options.mask);
    if (inside >= 0) outside = 1 - inside;
  }
  if (outside < 0) outside = border_region(result.labels, grid, options.mask, options.regions);
  if (outside == 0) return;
  const auto other = static_cast<std::uint8_t>(outside);
  for (std::uint8_t& label : result.labels) {
    if (label == 0)
      label = other;
    else if (label == other)
      label = 0;
  }
  if (options.regions > 2)
    std::swap(result.coefficients[0], result.coefficients[static_cast<std::size_t>(outside)]);
  else
    for (std::vector<float>& set : result.coefficients)
      for (float& c : set) c = -c;
}

// The variational method: on edges, locally or globally.
template <int Dim>
VariationalResult descend(const Lattice<Dim>& lattice, RegionForces<Dim>& forces, const ForceSource& source,
                          std::span<const float> values, const Grid& grid, double noise, SegmentOptions& options,
                          std::vector<std::uint8_t> labels) {
  if (options.energy == SegmentEnergy::edge && !options.force)
    return descend_to_edges(lattice, options, grid, edge_weights(values, grid), std::move(labels));
  const bool local = options.mode == SegmentMode::local;
  if (local && (!options.seed.empty() || !options.start.empty()))
    return descend_locally(lattice, source, options, grid, noise, std::move(labels));
  VariationalResult result = descend_globally(lattice, source, options, noise, std::move(labels));
  if (!local && can_be_shaded(options)) shade(lattice, forces, source, noise, options, result);
  choose_polarity(grid, options, result);
  return local ? descend_locally(lattice, source, options, grid, noise, std::move(result.labels)) : result;
}

// Where the image is speckle, places the contour where its blur says.
template <int Dim>
void place_in_speckle(Lattice<Dim>& lattice, std::span<const float> values, const Grid& grid,
                      const SegmentOptions& options, SegmentOptions& used, VariationalResult& result) {
  const bool suits = used.energy == SegmentEnergy::generalized_gaussian || used.energy == SegmentEnergy::rayleigh ||
                     used.energy == SegmentEnergy::gamma;
  if (!suits || options.force || options.regions > 2) return;
  std::vector<std::uint8_t> labels = result.labels;
  for (std::size_t i = 0; i < labels.size(); ++i)
    if (!options.mask.empty() && options.mask[i] == 0) labels[i] = no_region;
  const std::optional<SpeckleModel> speckle = find_speckle<Dim>(values, grid, labels);
  if (!speckle) return;
  result.report.speckle = speckle->exponent;
  if (!options.center_spacing) {
    used.center_spacing = std::max(*used.center_spacing, spacing_in_speckle<Dim>(*speckle, grid));
    lattice = Lattice<Dim>(grid.size, grid.spacing, {*used.center_spacing, *used.support, used.kernel});
    result.coefficients[0] = coefficients_of_labels(lattice, result.labels);
  }
  SpeckleContour<Dim> contour(lattice, *speckle, values, options.mask, options.prior, result.coefficients[0]);
  std::vector<double> steps;
  result.coefficients[0] = contour.descend(steps);
  update_labels(lattice, result.coefficients[0], result.labels.data());
  // The laws differ by a constant.
  std::vector<double>& energy = result.report.energy;
  for (std::size_t i = 1; i < steps.size(); ++i)
    energy.push_back(energy.back() + (steps[i] - steps[i - 1]) / static_cast<double>(labels.size()));
}

template <int Dim>
std::vector<std::shared_ptr<const Field<Dim>>> make_fields(const Lattice<Dim>& lattice,
                                                           const std::vector<std::vector<float>>& coefficients,
                                                           const Grid& grid) {
  std::vector<std::shared_ptr<const Field<Dim>>> single, fields;
  // One factor for all, so that the largest stays the largest.
  double slope = 0;
  for (const std::vector<float>& values : coefficients)
    slope += contour_slope(lattice, values) / static_cast<double>(coefficients.size());
  for (const std::vector<float>& values : coefficients)
    single.push_back(lattice_field(lattice, values, grid, slope > 0 ? slope : 1));
  if (single.size() == 1) return single;
  for (std::size_t k = 0; k < single.size(); ++k) fields.push_back(largest_field<Dim>(single, k));
  return fields;
}

}  // namespace

template <int Dim>
Segmentation<Dim> segment(const Volume<float>& image, const SegmentOptions& options) {
  check_options(options);
  check_image<Dim>(image, options);
  const Grid& grid = image.grid;
  const std::vector<float> repaired = finite_values(image, options.mask);
  const std::span<const float> values = repaired.empty() ? std::span<const float>(image.values) : repaired;
  check_contrast(values, options.mask);

  SegmentOptions used = choose_options(options);
  report(options.progress, "prepare", 0);
  const bool local = used.mode == SegmentMode::local;
  RegionForces<Dim> forces(values, grid, options.mask, law_of(options.energy), options.regions);
  ForceSource source = options.force ? custom_source(options) : intensity_source(forces, options.regions);
  source.prior = options.prior;

  // The noise is that between the two classes of the image: a seed may lie anywhere in them.
  const bool baseline = options.method != SegmentMethod::variational;
  const bool follows_seed = !options.seed.empty() && (local || baseline || options.force);
  std::vector<std::uint8_t> start = options.start.empty() && follows_seed ? options.seed : options.start;
  for (std::uint8_t& label : start) label = label != 0 ? 1 : 0;
  std::vector<std::uint8_t> labels = !start.empty() && options.force ? start : forces.start();
  source.fit(labels);
  ForceNoise noise = measure_noise(source, labels, options.mask, grid);
  constexpr double speckle = 1.5;  // a grain above: borders are within what the laws spread over anyway
  if (noise.grain > speckle) {
    forces.set_border(0);
    source.fit(labels);
  }
  if (!used.window) used.window = choose_window(options, noise, Dim);
  if (*used.window > 0) {
    forces.set_window(*used.window);
    noise = measure_noise(source, labels, options.mask, grid);
  }
  if (!start.empty()) {
    labels = std::move(start);
    source.fit(labels);
  }
  if (!used.center_spacing) used.center_spacing = choose_center_spacing(noise, Dim);

  VariationalResult result;
  std::vector<std::shared_ptr<const Field<Dim>>> fields;
  if (baseline) {
    result.labels = std::move(labels);
    if (options.seed.empty()) choose_polarity(grid, options, result);
    BaselineResult<Dim> found = segment_by_baseline<Dim>(grid, source, used, *used.center_spacing, result.labels);
    fields.push_back(std::move(found.field));
    result.labels = std::move(found.labels);
    result.report = std::move(found.report);
  } else {
    Lattice<Dim> lattice(grid.size, grid.spacing, {*used.center_spacing, *used.support, used.kernel});
    result = descend(lattice, forces, source, values, grid, noise.size, used, std::move(labels));
    place_in_speckle(lattice, values, grid, options, used, result);
    fields = make_fields(lattice, result.coefficients, grid);
  }
  if (!options.mask.empty())
    for (std::size_t i = 0; i < result.labels.size(); ++i)
      if (options.mask[i] == 0) result.labels[i] = 0;

  Segmentation<Dim> segmentation;
  segmentation.report = std::move(result.report);
  SegmentReport& report = segmentation.report;
  report.noise = noise.size;
  segmentation.fields = std::move(fields);
  segmentation.labels = std::move(result.labels);
  report.regions = measure_regions(segmentation.labels, values, grid, options.mask, options.regions);
  report.components = count_components(segmentation.labels, grid);
  for (const RegionReport& region : report.regions)
    if (region.voxels == 0)
      report.warnings.push_back("label " + std::to_string(region.label) +
                                " is empty: start elsewhere, or take another energy");
  report.options = std::move(used);
  report.options.seed.clear();
  report.options.mask.clear();
  report.options.start.clear();
  report.options.prior.clear();
  report.options.force = {};
  report.options.progress = {};
  return segmentation;
}

template Segmentation<2> segment<2>(const Volume<float>&, const SegmentOptions&);
template Segmentation<3> segment<3>(const Volume<float>&, const SegmentOptions&);

}  // namespace csrbf
