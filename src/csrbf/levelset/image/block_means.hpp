#pragma once

#include "csrbf/core/grid.hpp"

#include <functional>
#include <span>
#include <vector>

namespace csrbf {

/// How many voxels along each axis make a block, so that there are at most `most` blocks and their edges are as equal
/// as whole voxels allow.
std::array<Index, 3> block_size(const Grid& grid, Index most);

/// The grid of the blocks; those at the end of an axis may hold fewer voxels.
Grid block_grid(const Grid& grid, const std::array<Index, 3>& block);

/// The mean over each block of what `fill` writes for each row of voxels along x, counted over y, then z. O(voxels),
/// without memory for the voxels.
std::vector<float> block_means(const Grid& grid, const std::array<Index, 3>& block,
                               const std::function<void(Index row, std::span<float> to)>& fill);

}  // namespace csrbf
