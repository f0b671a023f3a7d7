#include "csrbf/levelset/partition/seed_costs.hpp"

#include <algorithm>
#include <cmath>

namespace csrbf {

SeedCosts seed_costs(std::span<const std::uint8_t> labels, double confidence, std::span<const float> confidences,
                     int regions) {
  SeedCosts result{labels, {}};
  if (labels.empty() || (confidences.empty() && confidence >= 1)) return result;
  const auto cost = [&](double p) {
    if (p >= 1) return certain_seed;
    const double ratio = p * (regions - 1) / (1 - p);
    return ratio > 1 ? std::min(certain_seed, static_cast<float>(std::log(ratio))) : 0.0F;
  };
  result.nats.assign(labels.size(), 0.0F);
  for (std::size_t i = 0; i < labels.size(); ++i)
    if (labels[i] != 0) result.nats[i] = cost(confidences.empty() ? confidence : static_cast<double>(confidences[i]));
  return result;
}

}  // namespace csrbf
