#pragma once

#include "csrbf/levelset/partition/partition.hpp"

namespace csrbf {

inline constexpr double closest_background = 0.025;  ///< that it averages over, of the longest side; by hand

/// The models that a search compares, from the simplest to the richest: each has to be worth its parameters. `few`:
/// constant means only, unless options.model says otherwise.
std::vector<PartitionModel> considered_models(const PartitionPrice& price, const PartitionOptions& options, bool few);

/// Whether labels of the simpler model are starts of the other: means that follow the image closely, and laws that take
/// a while, go on from what was found. `is_followed`: whether those labels have been improved.
bool goes_on_from(const PartitionModel& model, const PartitionModel& simpler, bool is_followed);

}  // namespace csrbf
