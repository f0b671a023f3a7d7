#include "csrbf/levelset/partition/seed_prior.hpp"

#include "csrbf/levelset/image/signed_distance.hpp"
#include "csrbf/levelset/partition/nearest_component.hpp"

#include <algorithm>

namespace csrbf {
namespace {

// Of each connected part the voxels at least half as far from its border as the one that is farthest.
std::vector<bool> core_of(std::vector<std::uint8_t> seed, const Grid& grid) {
  for (std::uint8_t& label : seed) label = label != 0 ? 1 : 0;
  const VoxelComponents parts = voxel_components(seed, 1, grid);
  const std::vector<float> depth = signed_distance(grid, seed.data());
  std::vector<float> deepest(parts.count, 0.0F);
  for (std::size_t i = 0; i < seed.size(); ++i)
    if (seed[i] != 0) deepest[parts.component[i]] = std::max(deepest[parts.component[i]], depth[i]);
  std::vector<bool> core(seed.size(), false);
  for (std::size_t i = 0; i < seed.size(); ++i) core[i] = seed[i] != 0 && 2 * depth[i] >= deepest[parts.component[i]];
  return core;
}

}  // namespace

std::vector<float> seed_prior(const SegmentOptions& options, const Grid& grid) {
  std::vector<float> prior = options.prior;
  if (options.seed.empty()) return prior;
  prior.resize(options.seed.size(), 0.0F);
  const std::vector<bool> core = core_of(options.seed, grid);
  for (std::size_t i = 0; i < prior.size(); ++i)
    if (core[i]) prior[i] -= certain_prior;
  return prior;
}

std::vector<float> prior_of_seeds(const SegmentOptions& options, const SeedCosts& seeds, const Grid& grid, bool local) {
  // A contour that moves from a seed keeps it, unless it starts elsewhere.
  std::vector<float> prior = local && options.start.empty() ? seed_prior(options, grid) : options.prior;
  if (options.seeds.empty()) return prior;
  prior.resize(options.seeds.size(), 0.0F);
  for (std::size_t i = 0; i < prior.size(); ++i)
    if (options.seeds[i] != 0)
      prior[i] += (options.seeds[i] == 2 ? -1.0F : 1.0F) * std::min(certain_prior, seeds.at(i));
  return prior;
}

void match_seeds(std::span<const std::uint8_t> seeds, std::span<std::uint8_t> labels) {
  Index same = 0;
  for (std::size_t i = 0; i < seeds.size(); ++i)
    if (seeds[i] != 0) same += labels[i] + 1 == seeds[i] ? 1 : -1;
  if (same >= 0) return;
  for (std::uint8_t& label : labels) label = 1 - label;
}

SegmentOptions starting_at_seeds(SegmentOptions options) {
  options.start.resize(options.seeds.size());
  for (std::size_t i = 0; i < options.seeds.size(); ++i) options.start[i] = options.seeds[i] == 2 ? 1 : 0;
  return options;
}

void keep_certain_seeds(const SeedCosts& seeds, std::span<std::uint8_t> labels) {
  for (std::size_t i = 0; i < seeds.labels.size(); ++i)
    if (seeds.is_certain(i)) labels[i] = seeds.labels[i] - 1;
}

}  // namespace csrbf
