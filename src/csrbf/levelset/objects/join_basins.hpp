#pragma once

#include "csrbf/core/grid.hpp"

#include <span>

namespace csrbf {

/// Joins touching basins (labels from 1 on; 0 is outside) as long as the description of their shapes becomes shorter,
/// the pair first that gains most. The shape of a basin costs, in nats, the place and the parameters of an ellipsoid
/// with its first and second moments, and 3 for each voxel that the ellipsoid misplaces, as much as two edges of a
/// contour. Labels stay those of one of the basins. O(n log n).
void join_basins(std::span<std::int32_t> labels, const Grid& grid);

}  // namespace csrbf
