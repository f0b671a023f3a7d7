#include "csrbf/levelset/image/block_means.hpp"

#include <gtest/gtest.h>

namespace csrbf::block_means_test {
namespace {

using Block = std::array<Index, 3>;

Grid grid_of(Index nx, Index ny, Index nz) {
  Grid grid;
  grid.size = {nx, ny, nz};
  return grid;
}

TEST(BlockMeans, AreThoseOfTheVoxelsOfABlock) {
  const Grid grid = grid_of(7, 5, 4);
  const Block block{3, 2, 4};
  const std::vector<float> means = block_means(grid, block, [&](Index row, std::span<float> to) {
    for (std::size_t x = 0; x < to.size(); ++x) to[x] = static_cast<float>(x) + 10 * static_cast<float>(row);
  });
  EXPECT_EQ(block_grid(grid, block).size, (Block{3, 3, 1}));
  ASSERT_EQ(means.size(), 9);
  for (Index j = 0; j < 3; ++j)
    for (Index i = 0; i < 3; ++i) {
      double sum = 0, count = 0;
      for (Index z = 0; z < 4; ++z)
        for (Index y = 2 * j; y < std::min<Index>(5, 2 * j + 2); ++y)
          for (Index x = 3 * i; x < std::min<Index>(7, 3 * i + 3); ++x) {
            sum += static_cast<double>(x + 10 * (y + 5 * z));
            count += 1;
          }
      constexpr double round_off = 1e-4;
      EXPECT_NEAR(static_cast<double>(means[j * 3 + i]), sum / count, round_off);
    }
}

TEST(BlockMeans, OfAsEqualEdgesAsVoxelsAllow) {
  EXPECT_EQ(block_size(grid_of(512, 512, 512), 1 << 21), (Block{4, 4, 4}));
  EXPECT_EQ(block_size(grid_of(100, 100, 100), 1 << 21), (Block{1, 1, 1}));
  Grid thick = grid_of(1000, 1000, 30);
  thick.spacing = Point<3>(1, 1, 5);
  const Block block = block_size(thick, 1 << 20);
  EXPECT_EQ(block[0], block[1]);
  EXPECT_GT(block[0], 4);
  EXPECT_LE(block[2], 2);
  EXPECT_EQ(block_size(grid_of(4000, 3000, 1), 1 << 21), (Block{3, 3, 1}));
}

TEST(BlockMeans, HaveAGridWhoseVoxelsAreInTheMiddleOfTheBlocks) {
  Grid grid = grid_of(9, 8, 6);
  grid.spacing = Point<3>(1, 2, 3);
  grid.origin = Point<3>(5, 6, 7);
  const Grid blocks = block_grid(grid, {3, 2, 1});
  EXPECT_EQ(blocks.size, (Block{3, 4, 6}));
  EXPECT_TRUE(blocks.spacing.isApprox(Point<3>(3, 4, 3)));
  EXPECT_TRUE(blocks.origin.isApprox(Point<3>(6, 7, 7)));
}

}  // namespace
}  // namespace csrbf::block_means_test
