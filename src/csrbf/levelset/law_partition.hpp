#pragma once

#include "csrbf/levelset/partition/partition.hpp"
#include "csrbf/levelset/segment_options.hpp"

namespace csrbf {

/// The model of regions that follow the law of the energy in use, echoes on the scale of nearly_normal().
PartitionModel model_of_law(const SegmentSettings& used);

/// The values on a scale on which the echoes of a region are nearly Gaussian: the cube root of what follows a gamma
/// distribution (Wilson and Hilferty 1931), of amplitudes that of their squares. For other energies as they are.
std::vector<float> nearly_normal(std::span<const float> values, std::span<const std::uint8_t> mask,
                                 SegmentEnergy energy);

/// Whether the labels of a lattice cost more than classes of single voxels, by means of that shape, by a share of the
/// price of their contour: then parts are lost between the centres.
bool loses_parts(PartitionPrice& price, MeanShape shape, std::span<const std::uint8_t> labels,
                 std::span<const std::uint8_t> classes);

/// Of labels by `model` and by means with one deviation those that the law describes in fewer nats, sharp or blurred;
/// the model becomes the one by which it does. Where borders are blurred, labels by deviations of their own give them
/// to the wider law. Where neighbours are alike, deviations follow the structures within regions: then those by means,
/// if these tell anything.
Partition better_by_law(PartitionPrice& price, const PartitionModel& model, Partition found, Partition means);

}  // namespace csrbf
