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

/// The mean over each block of an image that comes some slices at a time.
class BlockMeans {
 public:
  BlockMeans(const Grid& grid, const std::array<Index, 3>& block);

  /// Adds the slices [begin, end), which follow those before: `fill` writes the row of voxels along x with that number,
  /// counted over y, then z, in the whole image. Parallel; without memory for the voxels.
  void add(Index begin, Index end, const std::function<void(Index row, std::span<float> to)>& fill);

  /// After all slices.
  [[nodiscard]] std::vector<float> take();

 private:
  Grid grid_;
  std::array<Index, 3> block_, count_;
  std::vector<float> sums_;
};

/// The same of a whole image. O(voxels).
std::vector<float> block_means(const Grid& grid, const std::array<Index, 3>& block,
                               const std::function<void(Index row, std::span<float> to)>& fill);
std::vector<float> block_means(const Grid& grid, const std::array<Index, 3>& block, std::span<const float> values);

/// Gives each voxel the value of its block. O(voxels).
template <class T>
void fill_blocks(const Grid& grid, const std::array<Index, 3>& block, std::span<const T> of_blocks, std::span<T> to) {
  const std::array<Index, 3> count = block_grid(grid, block).size;
  std::size_t i = 0;
  for (Index z = 0; z < grid.size[2]; ++z)
    for (Index y = 0; y < grid.size[1]; ++y) {
      const Index row = count[0] * (y / block[1] + count[1] * (z / block[2]));
      for (Index x = 0; x < grid.size[0]; ++x) to[i++] = of_blocks[static_cast<std::size_t>(row + x / block[0])];
    }
}

}  // namespace csrbf
