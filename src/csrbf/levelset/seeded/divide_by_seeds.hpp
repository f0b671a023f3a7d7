#pragma once

#include "csrbf/levelset/partition/partition.hpp"

#include <array>
#include <set>

namespace csrbf {

/// Labels found with seeds, and what is known of the image.
struct SeededLabels {
  std::span<const float> values;
  double deviation = 0;                 ///< of what the means of the regions leave
  double grain = 1;                     ///< voxels that one independent value covers
  std::span<const std::uint8_t> mask;   ///< 0: does not count; may be empty
  std::span<const std::uint8_t> seeds;  ///< 1 + the label of voxels that keep it, 0 elsewhere
  std::span<std::uint8_t> labels;
};

/// Pairs of labels that intensities do not tell apart, in ascending order.
struct AlikeLabels {
  std::set<std::array<int, 2>> divided;  ///< by their seeds
  std::set<std::array<int, 2>> open;     ///< seeds leave open where one of them ends: labels stay

  [[nodiscard]] bool empty() const { return divided.empty() && open.empty(); }
};

/// Where two regions are alike, the shortest contour runs around the seeds of one, and the other takes all the rest. So
/// a part with seeds whose border with a larger part of another label is no edge of the image (means close by on both
/// sides differ by chance alone at most of it) is joined with that part, and both are divided again by nearest_seeds().
AlikeLabels divide_by_seeds(const Grid& grid, const SeededLabels& found);

/// The same for a partition, by the seeds that are certain; nothing without any. Of more than two regions, those whose
/// seeds differ by little more than two deviations become one first, whose contours are found again and which is
/// divided, where one mean describes both in fewer nats, or where one is unlike its own seeds, as what became the
/// blurred border of both is.
AlikeLabels divide_by_seeds(PartitionPrice& price, const SeedCosts& seeds, int regions, Partition& found);

}  // namespace csrbf
