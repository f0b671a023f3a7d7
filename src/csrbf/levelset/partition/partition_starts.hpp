#pragma once

#include "csrbf/levelset/partition/partition_model.hpp"

#include <functional>

namespace csrbf {

/// Labels that a search for the best partition may start from.
struct PartitionStart {
  std::vector<std::uint8_t> labels;
  bool classes = false;   ///< of all voxels: for any model
  bool local = false;     ///< by comparison with the surroundings: for means that vary
  bool close = false;     ///< with those close by: for a background
  bool of_ranks = false;  ///< of the values, whatever tails the noise has
};

/// Calls take() with one start after the other: classes of least variance after Gaussians of 0, 1, 2 and 4 voxels (of
/// two regions also of roots and logarithms), the brightest and darkest shares, what differs from its surroundings, by
/// values and by their ranks, what stands out from a local mean of all the rest, and the most and least textured. With
/// seeds, those of the values of the seeds only. `few`: only what is cheap, for large images. More than two regions
/// have classes, of the image and of what varying light leaves of it, only.
void for_partition_starts(const PartitionPrice& price, int regions, bool few,
                          const std::function<void(PartitionStart&&)>& take);

}  // namespace csrbf
