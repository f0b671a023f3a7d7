#include "csrbf/levelset/segment_local.hpp"

#include "csrbf/levelset/image/signed_distance.hpp"
#include "csrbf/levelset/seeded/ring_force.hpp"
#include "csrbf/levelset/seeded/seed_tissue.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace csrbf {

double spacing_for_ball(const Grid& grid, double voxels) {
  constexpr double finest = 2;      // by hand: less follows noise
  constexpr double per_radius = 3;  // centres; by hand: fewer shrink balls, more follow noise
  const double edge = grid.spacing.head(grid.dimension()).minCoeff();
  double volume = voxels;
  for (int a = 0; a < grid.dimension(); ++a) volume *= grid.spacing[a] / edge;
  const double radius =
      grid.dimension() == 2 ? std::sqrt(volume / std::numbers::pi) : std::cbrt(0.75 * volume / std::numbers::pi);
  return std::max(finest, radius / per_radius);
}

std::vector<float> prior_near(const SegmentOptions& options, const Grid& grid, std::span<const std::uint8_t> labels,
                              double distance) {
  std::vector<float> prior = seed_prior(options, grid);
  const std::vector<float> inside = signed_distance(grid, labels.data());
  prior.resize(labels.size(), 0.0F);
  for (std::size_t i = 0; i < inside.size(); ++i)
    if (static_cast<double>(inside[i]) < -distance) prior[i] += certain_prior;
  return prior;
}

namespace {

constexpr float outweighs = 1;  // what a voxel says, in the unit of the prior

// The voxels that the seed, seeds or prior keep inside, and the core of a start, which tells the tissue.
std::vector<std::uint8_t> kept_seed(const SegmentOptions& options, const Grid& grid) {
  SegmentOptions start;
  start.seed = options.start;
  start.prior = options.prior;
  std::vector<std::uint8_t> kept;
  for (const float cost : seed_prior(options.seed.empty() ? start : options, grid))
    kept.push_back(cost < -outweighs ? 1 : 0);
  for (std::size_t i = 0; i < options.seeds.size(); ++i)
    if (options.seeds[i] == 2) kept[i] = 1;
  return kept;
}

SeedCosts costs_of(const SegmentOptions& options) {
  return seed_costs(options.seeds, options.seed_confidence, options.seed_confidences, options.regions);
}

// The mask without the seeds that are certainly outside.
std::vector<std::uint8_t> mask_of(const SegmentOptions& options) {
  std::vector<std::uint8_t> mask = options.mask;
  if (options.seeds.empty()) return mask;
  if (mask.empty()) mask.assign(options.seeds.size(), 1);
  const SeedCosts costs = costs_of(options);
  for (std::size_t i = 0; i < mask.size(); ++i)
    if (options.seeds[i] == 1 && costs.is_certain(i)) mask[i] = 0;
  return mask;
}

// 1 where the prior lets nothing be inside.
std::vector<std::uint8_t> far_by_prior(const std::vector<float>& prior) {
  std::vector<std::uint8_t> far;
  for (const float cost : prior) far.push_back(cost > outweighs ? 1 : 0);
  return far;
}

// Whether fewer of some labels than of others differ from the start.
bool is_closer(std::span<const std::uint8_t> labels, std::span<const std::uint8_t> others,
               std::span<const std::uint8_t> start) {
  Index more = 0;
  for (std::size_t i = 0; i < start.size(); ++i)
    if (labels[i] != others[i]) more += (labels[i] != 0) == (start[i] != 0) ? -1 : 1;
  return more < 0;
}

// Mean of the values between two depths, in voxels of the shortest edge; none where there is none.
std::optional<double> mean_between(std::span<const float> values, std::span<const std::uint8_t> mask,
                                   std::span<const float> depth, double lo, double hi) {
  double count = 0, sum = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if ((!mask.empty() && mask[i] == 0) || !(depth[i] > lo && depth[i] < hi)) continue;
    ++count;
    sum += static_cast<double>(values[i]);
  }
  if (count == 0) return std::nullopt;
  return sum / count;
}

// For each end of each axis whether labels reach it.
std::array<std::array<bool, 2>, 3> reached_ends(std::span<const std::uint8_t> labels, const Grid& grid) {
  std::array<std::array<bool, 2>, 3> ends{};
  const std::array<Index, 3> strides{1, grid.size[0], grid.size[0] * grid.size[1]};
  for (std::size_t i = 0; i < labels.size(); ++i)
    for (std::size_t a = 0; labels[i] != 0 && a < 3; ++a) {
      const Index at = static_cast<Index>(i) / strides[a] % grid.size[a];
      if (grid.size[a] == 1) continue;
      ends[a][0] |= at == 0;
      ends[a][1] |= at + 1 == grid.size[a];
    }
  return ends;
}

bool reaches_border(std::span<const std::uint8_t> labels, const Grid& grid) {
  const auto ends = reached_ends(labels, grid);
  return std::any_of(ends.begin(), ends.end(), [](const auto& axis) { return axis[0] || axis[1]; });
}

bool spans_image(std::span<const std::uint8_t> labels, const Grid& grid) {
  const auto ends = reached_ends(labels, grid);
  return std::any_of(ends.begin(), ends.end(), [](const auto& axis) { return axis[0] && axis[1]; });
}

// A tissue with the rim around it: one that is all around, not much thicker than half the radius, and differs more from
// what is beyond than from what it encloses. None if it has none.
std::optional<SeedTissue> with_rim(const SeedTissue& core, std::span<const float> values, const Grid& grid,
                                   std::span<const std::uint8_t> mask, const SegmentOptions& options) {
  constexpr double begin = 0.95, end = 2.5;   // of the ring beyond, in voxels of the shortest edge
  constexpr double most = 1.6, least = 0.85;  // radii of the core; share of the ring; by hand
  const double edge = grid.spacing.head(grid.dimension()).minCoeff();
  const std::vector<float> depth = signed_distance(grid, core.labels.data());
  std::vector<std::uint8_t> ring(depth.size(), 0);
  double size = 0, ring_size = 0;
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const double beyond = -static_cast<double>(depth[i]) / edge;
    ring[i] = beyond > begin && beyond < end && (mask.empty() || mask[i] != 0) ? 1 : 0;
    size += core.labels[i];
    ring_size += ring[i];
  }
  if (ring_size == 0 || reaches_border(core.labels, grid)) return std::nullopt;
  std::optional<SeedTissue> rim = find_seed_tissue(values, grid, mask, ring, true, {}, far_by_prior(options.prior));
  if (!rim) return std::nullopt;
  double all = 0, covered = 0;
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const bool is_near = rim->labels[i] != 0 || static_cast<double>(depth[i]) > -end * edge;
    if (is_near && !options.seeds.empty() && options.seeds[i] == 1) return std::nullopt;  // seeds of the background
    if (core.labels[i] != 0) rim->labels[i] = 1;
    all += rim->labels[i];
    covered += ring[i] != 0 && rim->labels[i] != 0 ? 1 : 0;
  }
  if (covered < least * ring_size || reaches_border(rim->labels, grid) || all > std::pow(most, grid.dimension()) * size)
    return std::nullopt;
  const std::vector<float> whole = signed_distance(grid, rim->labels.data());
  const auto inner = mean_between(values, mask, depth, 0, std::numeric_limits<double>::max());
  const auto middle = mean_between(values, mask, depth, -end * edge, -begin * edge);
  const auto outer = mean_between(values, mask, whole, -end * edge, -begin * edge);
  if (!inner || !middle || !outer || std::abs(*outer - *middle) <= std::abs(*middle - *inner)) return std::nullopt;
  return rim;
}

}  // namespace

LocalTissue tissue_at_seed(std::span<const float> values, const SegmentOptions& options, const Grid& grid) {
  const std::vector<std::uint8_t> mask = mask_of(options);
  std::optional<SeedTissue> found =
      find_seed_tissue(values, grid, mask, kept_seed(options, grid), options.fill_holes.value_or(true), options.seeds,
                       far_by_prior(options.prior));
  LocalTissue tissue;
  if (!found) return tissue;
  if (!found->even) {
    tissue.warnings.emplace_back(
        "around the seed intensities vary by more than their noise, so that the contour may leak or stop early: look "
        "at it, and mark some of the background by seeds, or give a mask");
    return tissue;
  }
  std::optional<SeedTissue> both = with_rim(*found, values, grid, mask, options);
  const bool starts_there = !options.start.empty() && options.seeds.empty();
  if (both && (!starts_there || is_closer(both->labels, found->labels, options.start))) {
    found->labels = std::move(both->labels);
    tissue.warnings.emplace_back(
        "the seed lies in a core of another intensity than the rim around it: both were taken; with seeds of the "
        "background in the rim it is the core alone");
  }
  if (found->neck > 0)
    tissue.warnings.emplace_back(
        "a neck joins what was found to more of the same intensity, which was left out: a seed that has some of both "
        "takes both");
  if (spans_image(found->labels, grid))
    tissue.warnings.emplace_back(
        "what was found reaches from one end of the image to the other: it may have leaked; seeds of the background or "
        "a mask hold it");
  tissue.labels = std::move(found->labels);
  tissue.noise = found->noise;
  tissue.noisy = found->noisy;
  return tissue;
}

TissueContour following_tissue(const SegmentOptions& options, std::span<const float> values, const Grid& grid,
                               const LocalTissue& tissue, const std::vector<std::uint8_t>& labels) {
  SegmentOptions following = options;
  following.energy = SegmentEnergy::chan_vese;
  // Without a force the contour adds the seeds itself.
  following.prior = tissue.noisy ? seed_prior(options, grid) : prior_of_seeds(options, costs_of(options), grid, true);
  following.start = labels;
  following.seed.clear();
  if (tissue.noisy) return {std::move(following)};
  RingForce ring = ring_force(values, grid, options.mask, labels);
  const double noise = tissue.noise / std::max(ring.contrast, 1e-30);
  const auto inside = static_cast<double>(std::count(labels.begin(), labels.end(), std::uint8_t{1}));
  if (!following.center_spacing)
    following.center_spacing =
        std::min(choose_center_spacing({noise, 1}, grid.dimension()), std::floor(spacing_for_ball(grid, inside)));
  following.force = [force = std::move(ring.force)](const unsigned char*, float* to) {
    std::copy(force.begin(), force.end(), to);
  };
  return {std::move(following), noise};
}

}  // namespace csrbf
