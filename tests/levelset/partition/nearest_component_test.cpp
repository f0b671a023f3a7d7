#include "csrbf/levelset/partition/nearest_component.hpp"

#include <gtest/gtest.h>

#include <random>

namespace csrbf::nearest_component_test {
namespace {

Grid plane(Index nx, Index ny) {
  Grid grid;
  grid.axes = 2;
  grid.size = {nx, ny, 1};
  return grid;
}

TEST(NearestComponents, AreNumberedByTheirFirstVoxels) {
  const Grid grid = plane(5, 3);
  const std::vector<std::uint8_t> labels{0, 0, 1, 0, 1,  //
                                         1, 0, 1, 0, 1,  //
                                         1, 1, 1, 0, 0};
  const std::vector<std::int32_t> expected{-1, -1, 0, -1, 1, 0, -1, 0, -1, 1, 0, 0, 0, -1, -1};
  const VoxelComponents found = voxel_components(labels, 1, grid);
  EXPECT_EQ(found.count, 2U);
  EXPECT_EQ(found.component, expected);
}

TEST(NearestComponents, ReachEveryVoxelByTheFewestSteps) {
  Grid grid = plane(19, 13);
  grid.size[2] = 5;
  grid.axes = 3;
  std::mt19937 generator(1);
  std::bernoulli_distribution seldom(0.01);
  std::vector<std::uint8_t> labels(static_cast<std::size_t>(grid.voxels()));
  for (std::uint8_t& label : labels) label = seldom(generator) ? 1 : 0;
  const VoxelComponents own = voxel_components(labels, 1, grid), nearest = nearest_components(labels, 1, grid);
  const auto steps = [&](Index a, Index b) {
    const auto [nx, ny, nz] = grid.size;
    return std::abs(a % nx - b % nx) + std::abs(a / nx % ny - b / nx % ny) + std::abs(a / (nx * ny) - b / (nx * ny));
  };
  for (Index i = 0; i < grid.voxels(); ++i) {
    Index least = 1000, taken = 1000;
    for (Index j = 0; j < grid.voxels(); ++j) {
      if (own.component[j] < 0) continue;
      least = std::min(least, steps(i, j));
      if (own.component[j] == nearest.component[i]) taken = std::min(taken, steps(i, j));
    }
    ASSERT_EQ(taken, least) << i;
  }
}

TEST(NearestComponents, WithoutAnyAllVoxelsBelongToOne) {
  const VoxelComponents found = nearest_components(std::vector<std::uint8_t>(12, 0), 1, plane(4, 3));
  EXPECT_EQ(found.count, 1U);
  EXPECT_EQ(found.component, std::vector<std::int32_t>(12, 0));
}

TEST(NearestComponents, StandOutFromMostVoxelsBesideThem) {
  const std::vector<std::uint8_t> labels{1, 0, 0, 0, 0, 0, 0, 0, 1};
  const std::vector<float> values{5, 1, 1, 5, 0, 0, 5, 5, 5};
  const VoxelComponents nearest = nearest_components(labels, 1, plane(9, 1));
  const std::vector<double> means{5, 5};
  EXPECT_EQ(stand_out(nearest, values, {}, means, 1), (std::vector<bool>{true, false}));
  EXPECT_EQ(stand_out(nearest, values, {}, means, -1), (std::vector<bool>{false, false}));
}

}  // namespace
}  // namespace csrbf::nearest_component_test
