#include "csrbf/levelset/partition/grained_partition.hpp"

#include "csrbf/levelset/image/block_means.hpp"
#include "csrbf/levelset/image/noise_grain.hpp"
#include "csrbf/levelset/partition/blurred_price.hpp"

#include <cmath>

namespace csrbf {
namespace {

constexpr double cheaper = 0.6;  // contours where none are worth their price; by hand: 0.4 finds noise more often

double grain_left(PartitionPrice& price, const Partition& found) {
  return noise_grain(fit_blurred(price, found.labels, found.model).residual, price.grid(), price.mask());
}

// In much noise contours may cost more than what they tell apart. The gain that is told stays negative.
bool try_cheaper(PartitionPrice& price, const PartitionOptions& options, Partition& found) {
  price.scale_contours(cheaper);
  Partition other = find_partition(price, options);
  if (!(other.gain > 0)) {
    price.scale_contours(1 / cheaper);
    return false;
  }
  other.gain = found.gain;
  found = std::move(other);
  return true;
}

// The means of blocks of voxels in the mask, with a mask of their own where there is one.
struct Blocks {
  Grid grid;
  std::array<Index, 3> size;
  std::vector<float> values;
  std::vector<std::uint8_t> mask;
};

Blocks blocks_of(const PartitionPrice& price, Index most) {
  const Grid& grid = price.grid();
  const std::array<Index, 3> size = block_size(grid, most);
  Blocks result{block_grid(grid, size), size, block_means(grid, size, price.values()), {}};
  if (price.mask().empty()) return result;
  const std::vector<float> share = block_means(grid, size, [&](Index row, std::span<float> to) {
    for (std::size_t i = 0; i < to.size(); ++i)
      to[i] = price.inside(static_cast<std::size_t>(row) * to.size() + i) ? 1.0F : 0.0F;
  });
  result.mask.resize(share.size());
  for (std::size_t b = 0; b < share.size(); ++b) {
    result.mask[b] = share[b] >= 0.5F ? 1 : 0;
    if (result.mask[b] != 0) result.values[b] /= share[b];
  }
  return result;
}

// How means vary over an image of many voxels, and labels to start from, is found on blocks of these. What else regions
// differ in, blocks hide.
PartitionModel choose_on_blocks(const PartitionPrice& price, const PartitionOptions& options,
                                std::vector<std::uint8_t>& labels) {
  constexpr double usual_reach = 0.05;  // of a background; by hand
  if (!price.seeds().empty()) {
    PartitionModel model{options.shape.value_or(MeanShape::constant)};
    if (model.shape == MeanShape::background) model.reach = usual_reach;
    return model;
  }
  constexpr Index smaller = 4;  // a search on blocks takes a part of the time; by hand
  const Blocks means = blocks_of(price, options.many / smaller);
  const auto levels = static_cast<Index>(std::lround(0.5 / price.least_deviation()));
  PartitionPrice coarse(means.values, 0, 1, means.grid, means.mask, contour_weight(means.grid, price.weight().length),
                        levels);
  const Partition found =
      find_partition(coarse, {options.regions, options.shape, {}, {}, options.progress, options.many});
  if (found.labels.empty()) return {options.shape.value_or(MeanShape::constant)};
  const Grid& grid = price.grid();
  labels.resize(static_cast<std::size_t>(grid.voxels()));
  fill_blocks<std::uint8_t>(grid, means.size, found.labels, labels);
  PartitionModel model = found.model;
  model.own_deviations = model.own_shapes = false;
  // Structures within a region are no objects: that, only voxels tell.
  if (model.shape == MeanShape::objects && !options.shape) return {};
  return model;
}

// Where constant means describe the voxels as well as the means that blocks have.
void prefer_constant_means(PartitionPrice& price, PartitionOptions& options, Partition& found) {
  PartitionOptions constant = options;
  constant.model = PartitionModel();
  Partition other = find_partition(price, constant);
  if (other.labels.empty()) return;
  const double saved = found.labels.empty() ? 1 : found.energy.back() - other.energy.back();
  if (saved >= 0) {
    options.model = constant.model;
    std::swap(found, other);
  }
  if (other.labels.empty()) return;
  found.prices.push_back({other.model, std::abs(saved), true});
  found.others.push_back({other.model, std::move(other.labels)});
}

}  // namespace

Partition find_grained_partition(PartitionPrice& price, const PartitionOptions& given) {
  std::vector<std::uint8_t> start;
  PartitionOptions options = given;
  if (!options.model && price.grid().voxels() > given.many) {
    options.model = choose_on_blocks(price, given, start);
    if (options.start.empty()) options.start = start;
  }
  constexpr int rounds = 3;       // labels that follow the grain hide some of it from the first
  constexpr double grows = 1.25;  // by hand: less changes nothing
  Partition found = find_partition(price, options);
  if (!given.model && !given.shape && options.model && options.model->shape != MeanShape::constant)
    prefer_constant_means(price, options, found);
  if (options.regions > 2 || found.labels.empty()) return found;
  Partition clear;  // the last labels that are too clear to be noise
  double grain = 1, clear_grain = 1, now = grain_left(price, found);
  for (int round = 0; round < rounds && now >= grows * grain; ++round) {
    if (found.gain > 0 && are_clear(price, found.labels, found.model)) {
      clear = found;
      clear_grain = grain;
    }
    price.set_grain(now);
    PartitionOptions again = options;
    again.start = found.labels;  // no price is above that of the labels that showed the grain
    Partition coarse = find_partition(price, again);
    const double then = coarse.labels.empty() ? 1.0 : grain_left(price, coarse);
    // What coarse labels leave out shows structures that the fine ones have; or these were no noise. Objects that fill
    // the image look like a grain, which grows as labels follow fewer of them.
    const bool loses = coarse.gain < 0 && !clear.labels.empty();
    if (loses) {
      found = std::move(clear);
      grain = clear_grain;
    }
    if (then == 1 || loses) {
      price.set_grain(grain);
      break;
    }
    found = std::move(coarse);
    grain = now;
    now = then;
  }
  if (found.gain < 0) try_cheaper(price, options, found);
  if (price.seeds().empty() && found.gain > 0) found.in_blur = place_blurred_contour(price, found.model, found.labels);
  return found;
}

}  // namespace csrbf
