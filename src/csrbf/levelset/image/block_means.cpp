#include "csrbf/levelset/image/block_means.hpp"

#include "csrbf/core/parallel.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace csrbf {
namespace {

Index blocks_along(const Grid& grid, const std::array<Index, 3>& block, std::size_t a) {
  return (grid.size[a] + block[a] - 1) / block[a];
}

}  // namespace

std::array<Index, 3> block_size(const Grid& grid, Index most) {
  std::array<Index, 3> block{1, 1, 1};
  const auto edge = [&](std::size_t a) { return static_cast<double>(block[a]) * grid.spacing[static_cast<Index>(a)]; };
  const auto blocks = [&] {
    return blocks_along(grid, block, 0) * blocks_along(grid, block, 1) * blocks_along(grid, block, 2);
  };
  while (blocks() > most) {
    std::size_t shortest = 3;
    for (std::size_t a = 0; a < 3; ++a)
      if (grid.size[a] > block[a] && (shortest == 3 || edge(a) < edge(shortest))) shortest = a;
    const double wanted = edge(shortest) + grid.spacing[static_cast<Index>(shortest)];
    for (std::size_t a = 0; a < 3; ++a)
      if (grid.size[a] > 1)
        block[a] = std::clamp<Index>(std::lround(wanted / grid.spacing[static_cast<Index>(a)]), block[a], grid.size[a]);
  }
  return block;
}

Grid block_grid(const Grid& grid, const std::array<Index, 3>& block) {
  Grid blocks = grid;
  Point<3> first = Point<3>::Zero();  // centre of the first block, in voxels times the spacing
  for (std::size_t a = 0; a < 3; ++a) {
    const auto axis = static_cast<Index>(a);
    blocks.size[a] = blocks_along(grid, block, a);
    blocks.spacing[axis] *= static_cast<double>(block[a]);
    first[axis] = 0.5 * static_cast<double>(block[a] - 1) * grid.spacing[axis];
  }
  blocks.origin += grid.direction * first;
  return blocks;
}

BlockMeans::BlockMeans(const Grid& grid, const std::array<Index, 3>& block)
    : grid_(grid),
      block_(block),
      count_{blocks_along(grid, block, 0), blocks_along(grid, block, 1), blocks_along(grid, block, 2)},
      sums_(static_cast<std::size_t>(count_[0] * count_[1] * count_[2]), 0.0F) {}

void BlockMeans::add(Index begin, Index end, const std::function<void(Index row, std::span<float> to)>& fill) {
  const Index nx = count_[0], ny = count_[1];
  const Index first = begin / block_[2] * ny, last = ((end - 1) / block_[2] + 1) * ny;  // rows of blocks
  parallel_for(last - first, 1, [&](Index from, Index stop) {
    std::vector<float> row(static_cast<std::size_t>(grid_.size[0]));
    for (Index b = first + from; b < first + stop; ++b) {
      float* to = sums_.data() + b * nx;
      const Index y0 = b % ny * block_[1], y1 = std::min(y0 + block_[1], grid_.size[1]);
      const Index z0 = std::max(begin, b / ny * block_[2]), z1 = std::min(end, (b / ny + 1) * block_[2]);
      for (Index z = z0; z < z1; ++z)
        for (Index y = y0; y < y1; ++y) {
          fill(y + grid_.size[1] * z, row);
          for (Index i = 0, x = 0; i < nx; ++i)
            for (const Index to_x = std::min(x + block_[0], grid_.size[0]); x < to_x; ++x) to[i] += row[x];
        }
    }
  });
}

std::vector<float> BlockMeans::take() {
  const auto edge = [&](Index i, std::size_t a) { return std::min(block_[a], grid_.size[a] - i * block_[a]); };
  const Index nx = count_[0], ny = count_[1];
  parallel_for(ny * count_[2], 256, [&](Index begin, Index end) {
    for (Index b = begin; b < end; ++b)
      for (Index i = 0; i < nx; ++i)
        sums_[static_cast<std::size_t>(b * nx + i)] /=
            static_cast<float>(edge(i, 0) * edge(b % ny, 1) * edge(b / ny, 2));
  });
  return std::move(sums_);
}

std::vector<float> block_means(const Grid& grid, const std::array<Index, 3>& block,
                               const std::function<void(Index row, std::span<float> to)>& fill) {
  BlockMeans means(grid, block);
  means.add(0, grid.size[2], fill);
  return means.take();
}

std::vector<float> block_means(const Grid& grid, const std::array<Index, 3>& block, std::span<const float> values) {
  return block_means(grid, block, [&](Index row, std::span<float> to) {
    std::copy_n(values.begin() + row * grid.size[0], grid.size[0], to.begin());
  });
}

}  // namespace csrbf
