#pragma once

#include "csrbf/core/grid.hpp"

#include <span>
#include <vector>

namespace csrbf {

/// Joins touching basins (labels from 1 on; 0 is outside) as long as the description of their shapes becomes shorter,
/// the pair first that gains most. The shape of a basin costs, in nats, the place and the parameters of an ellipsoid
/// with its first and second moments, and 3 for each voxel that the ellipsoid misplaces, as much as two edges of a
/// contour; or, where that is less, those of an ellipsoid or a rod with round ends that are bent along an arc, or in
/// the plane of an ellipse with a hollow. A seam (not 0; may be empty) between two basins costs 3 for each pair of
/// voxels that face each other across it, if they are joined. Without seams, a basin that has parts of several
/// neighbours is divided among them where that is shorter, each voxel to the nearest. Labels stay those of one of the
/// basins. Prices of the shapes alone by label; 0 of those that are gone. O(n log n).
std::vector<double> join_basins(std::span<std::int32_t> labels, const Grid& grid,
                                std::span<const std::uint8_t> seams = {});

}  // namespace csrbf
