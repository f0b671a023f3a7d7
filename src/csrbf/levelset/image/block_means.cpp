#include "csrbf/levelset/image/block_means.hpp"

#include "csrbf/core/parallel.hpp"

#include <algorithm>
#include <cmath>

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

std::vector<float> block_means(const Grid& grid, const std::array<Index, 3>& block,
                               const std::function<void(Index row, std::span<float> to)>& fill) {
  const Index nx = blocks_along(grid, block, 0), ny = blocks_along(grid, block, 1), nz = blocks_along(grid, block, 2);
  std::vector<float> means(static_cast<std::size_t>(nx * ny * nz), 0.0F);
  parallel_for(ny * nz, 1, [&](Index begin, Index end) {
    std::vector<float> row(static_cast<std::size_t>(grid.size[0]));
    for (Index b = begin; b < end; ++b) {
      float* to = means.data() + b * nx;
      const Index y0 = b % ny * block[1], y1 = std::min(y0 + block[1], grid.size[1]);
      const Index z0 = b / ny * block[2], z1 = std::min(z0 + block[2], grid.size[2]);
      for (Index z = z0; z < z1; ++z)
        for (Index y = y0; y < y1; ++y) {
          fill(y + grid.size[1] * z, row);
          for (Index i = 0, x = 0; i < nx; ++i)
            for (const Index stop = std::min(x + block[0], grid.size[0]); x < stop; ++x) to[i] += row[x];
        }
      for (Index i = 0; i < nx; ++i) {
        const Index along = std::min(block[0], grid.size[0] - i * block[0]);
        to[i] /= static_cast<float>(along * (y1 - y0) * (z1 - z0));
      }
    }
  });
  return means;
}

}  // namespace csrbf
