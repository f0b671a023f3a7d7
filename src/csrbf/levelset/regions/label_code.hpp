#pragma once

#include "csrbf/core/grid.hpp"

#include <span>

namespace csrbf {

/// The length in nats of a code for labels 0 and 1, as of pictures by fax (JBIG): each voxel is coded by the labels of
/// seven neighbours before it, with probabilities learned on the way (Krichevsky and Trofimov 1981). It is short where
/// contours are straight, smooth or repeat themselves, and costs about the logarithm of the number of voxels for each
/// part. `mask`: 0 in voxels that do not count; may be empty. O(voxels).
double label_code(std::span<const std::uint8_t> labels, const Grid& grid, std::span<const std::uint8_t> mask);

}  // namespace csrbf
