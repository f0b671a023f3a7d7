#pragma once

#include "csrbf/levelset/partition/partition_contours.hpp"

#include <array>
#include <optional>

namespace csrbf {

/// Two regions that differ in how their voxels are like their neighbours.
struct TexturePartition {
  Partition partition;
  std::vector<float> force;           ///< the cost of a voxel in region 1 minus that in region 0
  std::array<double, 2> predicted{};  ///< share of the variance of each region that its neighbours tell
};

/// Regions of textures, where those of intensities tell hardly anything: their price by NeighbourCode, followed as by
/// find_partition(). To be taken they must tell more than twice what `found`, two regions of intensities, does by the
/// same code for what its means leave, and more than one region; each must be noise, and their predictions must differ,
/// not their deviations alone; none else. `price` must have no grain.
std::optional<TexturePartition> find_texture_partition(PartitionPrice& price, const Partition& found);

/// Level sets of these, as by partition_contours().
template <int Dim>
PartitionContours<Dim> texture_contours(PartitionPrice& price, Partition& partition, std::span<const float> force,
                                        const LatticeOptions& given, bool spacing_is_given);

}  // namespace csrbf
