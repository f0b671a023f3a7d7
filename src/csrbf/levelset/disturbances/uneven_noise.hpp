#pragma once

#include "csrbf/levelset/partition/partition_model.hpp"

#include <optional>
#include <vector>

namespace csrbf {

/// How the deviation of the noise varies over the place: a quadratic for its logarithm and a local mean of what that
/// leaves.
struct UnevenNoise {
  std::vector<float> certainty;  ///< 1 over its variance, with the geometric mean 1 in the mask
  double growth;                 ///< largest over least deviation
  double price;                  ///< nats, of its parameters
};

/// From second differences in windows of 3 x 3 voxels; none where no deviation is twice another. With labels
/// of two regions only what varies within them. O(voxels).
std::optional<UnevenNoise> find_uneven_noise(const PartitionPrice& price, std::span<const std::uint8_t> labels = {});

}  // namespace csrbf
