#include "csrbf/levelset/partition/seed_prior.hpp"

#include <algorithm>

namespace csrbf {

std::vector<float> prior_of_seeds(const SegmentOptions& options, const SeedCosts& seeds, bool local) {
  constexpr float certain = 10;  // mean costs of a voxel in the wrong region
  std::vector<float> prior = options.prior;
  if (!options.seeds.empty()) {
    prior.resize(options.seeds.size(), 0.0F);
    for (std::size_t i = 0; i < prior.size(); ++i)
      if (options.seeds[i] != 0) prior[i] += (options.seeds[i] == 2 ? -1.0F : 1.0F) * std::min(certain, seeds.at(i));
  }
  // A contour that moves from a seed keeps the seed inside, unless it starts elsewhere.
  if (!local || options.seed.empty() || !options.start.empty()) return prior;
  prior.resize(options.seed.size(), 0.0F);
  for (std::size_t i = 0; i < prior.size(); ++i)
    if (options.seed[i] != 0) prior[i] -= certain;
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
