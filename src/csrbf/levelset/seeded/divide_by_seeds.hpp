#pragma once

#include "csrbf/levelset/partition/grained_partition.hpp"

#include <array>

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

/// Where two regions are alike, the shortest contour runs around the seeds of one, and the other takes all the rest. So
/// a part with seeds whose border with a larger part of another label is no edge of the image (means close by on both
/// sides differ by chance alone at most of it) is joined with that part, and both are divided again by nearest_seeds().
/// Returns the pairs of labels that changed, in ascending order.
std::vector<std::array<int, 2>> divide_by_seeds(const Grid& grid, const SeededLabels& found);

/// The same for a partition, by the seeds that are certain; nothing without any. Of more than two regions, those whose
/// seeds differ by little more than two deviations are searched for as one first, and that is divided, where one mean
/// describes both in fewer nats, or where one is unlike its own seeds, as what became the blurred border of both is.
/// `options`: as for `found`. Returns the pairs of labels between which seeds alone decide.
std::vector<std::array<int, 2>> divide_by_seeds(PartitionPrice& price, const SeedCosts& seeds,
                                                const PartitionOptions& options, Partition& found);

}  // namespace csrbf
