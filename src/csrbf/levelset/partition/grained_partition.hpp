#pragma once

#include "csrbf/levelset/partition/partition.hpp"

namespace csrbf {

/// find_partition(), of two regions once more where what the first one leaves is blurred noise: then its likelihoods
/// count by the grain of that noise (noise_grain()), as `price` does from then on.
Partition find_grained_partition(PartitionPrice& price, const PartitionOptions& options = {});

}  // namespace csrbf
