#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace csrbf {

/// What seeds cost in nats in another region than theirs, one per voxel.
struct SeedCosts {
  std::span<const std::uint8_t> labels;  ///< 1 + the label of the seed, 0 elsewhere; empty: no seeds
  std::vector<float> nats;               ///< certain_seed for those that keep their label; empty: all do

  [[nodiscard]] bool is_certain(std::size_t i) const;
  [[nodiscard]] float at(std::size_t i) const;
};

/// More than any contour could save.
inline constexpr float certain_seed = 100;

/// Seeds that are right with these probabilities (one per voxel), or, when there are none, with the single one. A seed
/// that is wrong is as likely to be in any other of the regions: its cost is the logarithm of the ratio, at least 0.
SeedCosts seed_costs(std::span<const std::uint8_t> labels, double confidence, std::span<const float> confidences,
                     int regions);

inline float SeedCosts::at(std::size_t i) const {
  return nats.empty() ? certain_seed : nats[i];
}
inline bool SeedCosts::is_certain(std::size_t i) const {
  return labels[i] != 0 && at(i) >= certain_seed;
}

}  // namespace csrbf
