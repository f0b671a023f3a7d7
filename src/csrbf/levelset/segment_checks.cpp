#include "csrbf/levelset/segment_checks.hpp"

#include "csrbf/core/error.hpp"

#include <Eigen/Core>

namespace csrbf {
namespace {

constexpr const char* here = "segment";

// Centres more than half the image apart resolve nothing, and the stencils take memory of the order of spacing^Dim.
template <int Dim>
void check_center_spacing(const Grid& grid, double center_spacing) {
  constexpr double most = Dim == 2 ? 256 : 40;  // voxels: 65536 and 64000 phases
  const auto sides = Eigen::Map<const Eigen::Array<Index, 3, 1>>(grid.size.data()).head<Dim>().template cast<double>();
  const auto edges = grid.spacing.head<Dim>().array();
  const double half = std::floor((sides * edges).maxCoeff() / edges.minCoeff() / 2);
  const double largest = std::clamp(half, 1.0, most);
  std::ostringstream constraint;
  constraint << "must be at most " << largest << " voxels for this image"
             << (half <= most ? ", half its longest side" : "") << "; leave it out to have it chosen";
  require(center_spacing <= largest, here, "center_spacing", center_spacing, constraint.str());
}

// Throws for an array that is neither empty nor set in a voxel of the mask.
void check_array(const std::vector<std::uint8_t>& array, const char* name, std::size_t voxels,
                 const std::vector<std::uint8_t>& mask) {
  if (array.empty()) return;
  require(array.size() == voxels, here, std::string(name) + " size", array.size(),
          "must be the number of voxels, " + std::to_string(voxels));
  bool any = false;
  for (std::size_t i = 0; i < voxels && !any; ++i)
    any = array[i] != 0 && (mask.empty() || mask.size() != voxels || mask[i] != 0);
  require(
      any, here, name, "empty",
      std::string(name) == "mask" ? "must be set in some voxels" : "must have voxels inside the image and its mask");
}

bool needs_choice(Shading shading) {
  return shading == Shading::smooth || shading == Shading::objects || shading == Shading::background;
}

}  // namespace

std::optional<MeanShape> shape_of(Shading shading) {
  if (shading == Shading::automatic) return std::nullopt;
  return static_cast<MeanShape>(static_cast<int>(shading) - static_cast<int>(Shading::none));
}
Shading shading_of(MeanShape shape) {
  return static_cast<Shading>(static_cast<int>(shape) + static_cast<int>(Shading::none));
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

bool chooses_model(const SegmentOptions& given) {
  return given.energy == SegmentEnergy::automatic && given.mode == SegmentMode::global &&
         given.method == SegmentMethod::variational && !given.force && given.start.empty() && given.prior.empty() &&
         !given.window && !given.smoothness;
}

bool is_large(const SegmentOptions& given, Index voxels) {
  return chooses_model(given) && voxels > most_chosen_voxels && given.regions == 2 && given.seeds.empty() &&
         !given.center_spacing && !given.fill_holes.value_or(false) &&
         (given.shading == Shading::automatic || given.shading == Shading::none);
}

LargePartitionOptions large_options(const Grid& grid, const SegmentSettings& settings, const Progress& progress) {
  return {.weight = contour_weight(grid, contour_length),
          .support = *settings.support,
          .kernel = settings.kernel,
          .progress = progress};
}

template <int Dim>
void use_large(const LargePartition<Dim>& found, SegmentSettings& used) {
  used.shading = Shading::none;
  used.smoothness = found.smoothness;
  used.center_spacing = found.spacing;
  used.window = 0;
}

void warn_of_empty(const std::vector<RegionReport>& regions, std::vector<std::string>& warnings) {
  for (const RegionReport& region : regions)
    if (region.voxels == 0)
      warnings.push_back("label " + std::to_string(region.label) +
                         " is empty: start elsewhere, or take another energy");
}

bool warn_of_alike(const AlikeLabels& alike, std::vector<std::string>& warnings) {
  const auto names = [](const std::array<int, 2>& pair) {
    return "labels " + std::to_string(pair[0]) + " and " + std::to_string(pair[1]);
  };
  for (const auto& pair : alike.divided)
    warnings.push_back(names(pair) + " have seeds where intensities do not differ: there the border between them is " +
                       "that of the seeds, midway or at a neck, not one of the image; more seeds move it");
  for (const auto& pair : alike.open)
    if (!alike.divided.contains(pair))
      warnings.push_back(names(pair) + " have seeds where intensities do not differ, too few to say where one ends: " +
                         "what either has there means little; mark more of both");
  return !alike.empty();
}

bool chooses_local_energy(const SegmentOptions& given, Index voxels) {
  return given.energy == SegmentEnergy::automatic && given.mode == SegmentMode::local &&
         given.method == SegmentMethod::variational && !given.force && !given.window && !given.smoothness &&
         voxels <= most_chosen_voxels;
}

bool follows_start(const SegmentOptions& given) {
  return given.mode == SegmentMode::local && given.method == SegmentMethod::variational &&
         given.energy != SegmentEnergy::edge && !(given.seed.empty() && given.start.empty() && given.seeds.empty());
}

PartitionPrice partition_price(std::span<const float> values, std::span<const float> image, const Grid& grid,
                               std::span<const std::uint8_t> mask) {
  const Index levels = choose_bins(image, 256, mask).count;
  const IntensityBins bins = choose_bins(values, std::max<Index>(2, levels), mask);
  return {values, bins.lo, bins.hi, grid, mask, contour_weight(grid, contour_length), bins.count};
}

bool can_be_shaded(const SegmentSettings& used) {
  return used.shading != Shading::none &&
         (used.energy == SegmentEnergy::chan_vese || used.energy == SegmentEnergy::gaussian);
}

bool may_be_speckle(const SegmentSettings& used) {
  const bool suits = used.energy == SegmentEnergy::generalized_gaussian || used.energy == SegmentEnergy::rayleigh ||
                     used.energy == SegmentEnergy::gamma;
  return suits && used.regions == 2;
}

bool follows_law(const SegmentOptions& given, Index voxels) {
  SegmentOptions chosen = given;
  chosen.energy = SegmentEnergy::automatic;
  return given.energy != SegmentEnergy::automatic && given.energy != SegmentEnergy::edge && chooses_model(chosen) &&
         given.regions == 2 && voxels <= most_chosen_voxels;
}

SegmentOptions with_choice_of_means(const SegmentOptions& given, Index voxels) {
  constexpr Index fewest = 1000, most = 1 << 18;  // voxels; in more the search takes twenty times as long
  SegmentOptions chosen = given;
  chosen.energy = SegmentEnergy::automatic;
  if (given.regions == 2 || given.energy != SegmentEnergy::chan_vese || voxels < fewest || voxels > most ||
      !chooses_model(chosen))
    return given;
  if (chosen.shading == Shading::automatic) chosen.shading = Shading::none;
  return chosen;
}

SegmentEnergy energy_of(const PartitionModel& model) {
  if (model.own_shapes) return SegmentEnergy::generalized_gaussian;
  return model.own_deviations ? SegmentEnergy::gaussian : SegmentEnergy::chan_vese;
}

std::vector<EnergyPrice> price_list(const std::vector<ModelPrice>& prices) {
  std::vector<EnergyPrice> list;
  list.reserve(prices.size());
  for (const ModelPrice& each : prices)
    list.push_back({energy_of(each.model), shading_of(each.model.shape), each.nats});
  return list;
}

// About 50 voxels of independent noise distinguish two textures; the centers smooth further.
int choose_window(const SegmentOptions& given, const ForceNoise& noise, int dimension) {
  if (given.energy != SegmentEnergy::generalized_gaussian || given.force) return 0;
  return static_cast<int>(std::lround((dimension == 2 ? 3 : 1) * noise.grain));
}

// The settings with values in place of `automatic`, but for the center spacing, the window and the shading.
SegmentSettings choose_settings(const SegmentOptions& given, Index voxels) {
  SegmentSettings used = given;
  const bool edge = used.energy == SegmentEnergy::edge && !given.force;
  if (edge) used.mode = SegmentMode::local;
  const bool chosen = chooses_model(given) && voxels <= most_chosen_voxels;
  require(chosen || !needs_choice(given.shading), here, "shading", std::string(name_of(given.shading)),
          "is for images of at most 8 million voxels");
  require(chosen || given.seeds.empty() || given.regions == 2, here, "seeds", "given",
          "of more than two regions are for images of at most 8 million voxels");
  if (used.energy == SegmentEnergy::automatic && !chosen) used.energy = SegmentEnergy::chan_vese;
  const bool smooth_by_centers = !used.smoothness || *used.smoothness > 0;
  if (!used.center_spacing && !smooth_by_centers && !chosen) used.center_spacing = 1;
  if (!used.smoothness && !chosen) used.smoothness = edge ? 1 : 0;
  if (!used.support) used.support = used.method == SegmentMethod::collocation ? 4 : 2.5;
  if (!used.fill_holes) used.fill_holes = used.mode == SegmentMode::local;
  return used;
}

void check_segment_options(const SegmentOptions& options) {
  require(options.regions >= 2 && options.regions <= 16, here, "regions", options.regions, "must be 2 to 16");
  require(options.seed_confidence > 0 && options.seed_confidence <= 1, here, "seed_confidence", options.seed_confidence,
          "must be a probability, above 0 and at most 1");
  require(options.seed_confidences.empty() || !options.seeds.empty(), here, "seed_confidences", "given", "need seeds");
  require(options.iterations > 0, here, "iterations", options.iterations, "must be positive");
  if (options.smoothness)
    require(*options.smoothness >= 0 && std::isfinite(*options.smoothness), here, "smoothness", *options.smoothness,
            "must not be negative");
  if (options.window)
    require(*options.window >= 0 && *options.window <= 1000, here, "window", *options.window, "must be 0 to 1000");
  require(options.balloon >= -1 && options.balloon <= 1, here, "balloon", options.balloon, "must be in [-1, 1]");
  const bool is_filled = options.fill_holes.value_or(false);
  require(!is_filled || (options.regions == 2 && options.method == SegmentMethod::variational), here, "fill_holes",
          "yes", "needs two regions and the method variational");
  if (options.regions > 2) {
    require(options.mode == SegmentMode::global && options.method == SegmentMethod::variational, here, "regions",
            options.regions, "more than two need the mode global and the method variational");
    require(options.energy != SegmentEnergy::edge && !options.force, here, "regions", options.regions,
            "more than two need an energy of intensities");
    require(options.seed.empty() && options.start.empty() && options.prior.empty(), here, "regions", options.regions,
            "seed, start and prior are for two regions");
  }
  if (needs_choice(options.shading))
    require(chooses_model(options) && options.regions == 2, here, "shading", std::string(name_of(options.shading)),
            "needs the energy auto in global mode, two regions, and no window, smoothness, start or prior");
  if (options.method != SegmentMethod::variational)
    require(options.energy != SegmentEnergy::edge || options.force, here, "energy", "edge",
            "needs the method variational");
  if (options.energy == SegmentEnergy::edge && !options.force)
    require(!options.seed.empty(), here, "energy", "edge", "needs a seed to start from (init)");
}

namespace {

// Of every region at least one voxel.
void check_seeds(const SegmentOptions& options, std::size_t voxels) {
  if (options.seeds.empty()) return;
  require(options.seeds.size() == voxels, here, "seeds size", options.seeds.size(),
          "must be the number of voxels, " + std::to_string(voxels));
  const bool variational = options.method == SegmentMethod::variational;
  require(variational && options.energy != SegmentEnergy::edge && !options.force, here, "seeds", "given",
          "need the method variational and an energy of intensities");
  require(options.regions == 2 || chooses_model(options), here, "seeds", "given",
          "of more than two regions need the energy auto, and no window or smoothness");
  const bool local = options.mode == SegmentMode::local;
  require(local || options.seed.empty(), here, "seeds", "given", "replace the seed in global mode");
  require(options.seed_confidences.empty() || options.seed_confidences.size() == voxels, here, "seed_confidences size",
          options.seed_confidences.size(), "must be the number of voxels, " + std::to_string(voxels));
  for (std::size_t i = 0; i < options.seed_confidences.size(); ++i)
    require(options.seeds[i] == 0 || (options.seed_confidences[i] >= 0 && options.seed_confidences[i] <= 1), here,
            "seed_confidences", options.seed_confidences[i], "must be probabilities, from 0 to 1");
  std::vector<Index> counts(static_cast<std::size_t>(options.regions) + 1, 0);
  for (std::size_t i = 0; i < voxels; ++i) {
    require(options.seeds[i] <= options.regions, here, "seeds", static_cast<int>(options.seeds[i]),
            "must be at most the number of regions, " + std::to_string(options.regions));
    if (options.mask.empty() || options.mask[i] != 0) ++counts[options.seeds[i]];
  }
  const bool starts = !options.seed.empty() || !options.start.empty();
  for (std::size_t k = 1; k < counts.size(); ++k)
    require(counts[k] > 0 || (local && (k == 1 || starts)), here, "seeds", "without " + std::to_string(k),
            "must mark every region, the background too: 1 marks label 0, 2 label 1, and so on");
}

}  // namespace

template <int Dim>
void check_segment_image(const Volume<float>& image, const SegmentOptions& options) {
  const Grid& grid = image.grid;
  const auto voxels = static_cast<std::size_t>(grid.voxels());
  require(image.components >= 1 && image.components <= 64, here, "components", image.components,
          "the image must have 1 to 64 values per voxel");
  require(image.frames == 1, here, "frames", image.frames, "the image must have one frame; track() takes sequences");
  require(std::ssize(image.values) == image.values_per_frame(), here, "number of values", image.values.size(),
          "must be that of the voxels and their components");
  for (std::size_t a = 0; a < 3; ++a)
    require(a < Dim ? grid.size[a] >= 2 : grid.size[a] == 1, here, "size", grid.size[a],
            a < Dim ? "the image must have at least 2 voxels along each axis" : "the image has too many axes");
  for (int a = 0; a < Dim; ++a)
    require(grid.spacing[a] > 0 && std::isfinite(grid.spacing[a]), here, "spacing", grid.spacing[a],
            "must be positive and finite");
  if (options.center_spacing) check_center_spacing<Dim>(grid, *options.center_spacing);
  check_array(options.mask, "mask", voxels, options.mask);
  check_array(options.seed, "seed", voxels, options.mask);
  check_array(options.start, "start", voxels, options.mask);
  check_seeds(options, voxels);
  require(options.prior.empty() || options.prior.size() == voxels, here, "prior size", options.prior.size(),
          "must be the number of voxels, " + std::to_string(voxels));
}

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

void check_contrast(std::span<const float> values, const std::vector<std::uint8_t>& mask) {
  const auto takes_part = [&](std::size_t i) { return mask.empty() || mask[i] != 0; };
  float least = std::numeric_limits<float>::infinity(), most = -least;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!takes_part(i)) continue;
    least = std::min(least, values[i]);
    most = std::max(most, values[i]);
  }
  require(least < most, here, "image", least, "a constant image has no regions to tell apart");
  constexpr float few = 4;  // steps of single precision: contrasts below are lost in it; by hand
  const float step = std::numeric_limits<float>::epsilon() * std::max(std::abs(least), std::abs(most));
  require(most - least > few * step, here, "image", most,
          "its values differ by less than single precision tells apart; subtract a constant from them");
}

template void use_large<2>(const LargePartition<2>&, SegmentSettings&);
template void use_large<3>(const LargePartition<3>&, SegmentSettings&);
template void check_segment_image<2>(const Volume<float>&, const SegmentOptions&);
template void check_segment_image<3>(const Volume<float>&, const SegmentOptions&);

}  // namespace csrbf
