#include "csrbf/approx/images/missing_voxels.hpp"

#include <gtest/gtest.h>

namespace csrbf::missing_voxels_test {
namespace {

constexpr Index width = 64;

// A square of missing pixels.
VoxelMask hole_at(Index x, Index y, Index side) {
  VoxelMask mask(static_cast<std::size_t>(width * width), 0);
  for (Index j = y; j < y + side; ++j)
    for (Index i = x; i < x + side; ++i) mask[static_cast<std::size_t>(j * width + i)] = 1;
  return mask;
}

struct Sides {
  Index left = 0, right = 0, above = 0, below = 0, in_hole = 0;
};

Sides sides_of(const VoxelMask& trial, Index x, Index y, Index side) {
  Sides sides;
  for (Index j = 0; j < width; ++j)
    for (Index i = 0; i < width; ++i) {
      if (trial[static_cast<std::size_t>(j * width + i)] == 0) continue;
      const bool in_x = i >= x && i < x + side, in_y = j >= y && j < y + side;
      sides.left += i < x ? 1 : 0;
      sides.right += i >= x + side ? 1 : 0;
      sides.above += j < y ? 1 : 0;
      sides.below += j >= y + side ? 1 : 0;
      sides.in_hole += in_x && in_y ? 1 : 0;
    }
  return sides;
}

Grid pixels() {
  Grid grid;
  grid.size = {width, width, 1};
  return grid;
}

// A hole between a flat and a textured part: both must be tried.
TEST(MissingVoxels, TrialHolesAreOnAllSidesOfAHole) {
  const Sides sides = sides_of(trial_holes(hole_at(27, 27, 10), pixels(), width * width - 100), 27, 27, 10);
  EXPECT_GT(sides.left, 0);
  EXPECT_GT(sides.right, 0);
  EXPECT_GT(sides.above, 0);
  EXPECT_GT(sides.below, 0);
  EXPECT_EQ(sides.in_hole, 0);
}

TEST(MissingVoxels, TrialHolesAreWhereTheImageIs) {
  const Sides sides = sides_of(trial_holes(hole_at(0, 27, 10), pixels(), width * width - 100), 0, 27, 10);
  EXPECT_EQ(sides.left, 0);
  EXPECT_GT(sides.right, 0);
}

TEST(MissingVoxels, ScatteredPixelsHaveNoTrialHoles) {
  VoxelMask mask(static_cast<std::size_t>(width * width), 0);
  for (std::size_t i = 0; i < mask.size(); i += 7) mask[i] = 1;
  const Index known = std::count(mask.begin(), mask.end(), 0);
  EXPECT_EQ(std::count_if(mask.begin(), mask.end(), [](auto m) { return m != 0; }) + known, width * width);
  const VoxelMask trial = trial_holes(mask, pixels(), known);
  EXPECT_EQ(std::count(trial.begin(), trial.end(), 1), 0);
}

}  // namespace
}  // namespace csrbf::missing_voxels_test
