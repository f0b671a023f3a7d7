#pragma once

#include "csrbf/levelset/partition/partition.hpp"

namespace csrbf {

inline constexpr double closest_background = 0.025;  ///< that it averages over, of the longest side; by hand

/// The models that a search compares, from the simplest to the richest: each has to be worth its parameters. `few`:
/// constant means only, unless options.model says otherwise.
std::vector<PartitionModel> considered_models(const PartitionPrice& price, const PartitionOptions& options, bool few);

}  // namespace csrbf
