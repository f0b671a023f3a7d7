#pragma once

#include "csrbf/levelset/partition/partition.hpp"

namespace csrbf {

/// find_partition(), of two regions once more where what the first one leaves is blurred noise: then its likelihoods
/// count by the grain of that noise (noise_grain()), as `price` does from then on. Where one region describes the image
/// as shortly, once more with contours at 0.6 of their price, which `price` then has if two are the shorter. If there
/// are more than `many` voxels, blocks of them decide how the means vary, and their labels are a start.
Partition find_grained_partition(PartitionPrice& price, const PartitionOptions& options = {});

}  // namespace csrbf
