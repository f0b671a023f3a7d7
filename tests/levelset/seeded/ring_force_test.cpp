#include "csrbf/levelset/seeded/ring_force.hpp"

#include <gtest/gtest.h>

namespace csrbf::ring_force_test {
namespace {

// Left of the object it is darker, right of it brighter than inside: each side has its own border.
TEST(RingForce, KnowsWhatIsBeyondEachSide) {
  constexpr Index n = 40;
  Grid grid;
  grid.axes = 2;
  grid.size = {n, n, 1};
  std::vector<float> values(static_cast<std::size_t>(n * n));
  std::vector<std::uint8_t> labels(values.size());
  for (Index i = 0; i < n * n; ++i) {
    const Index x = i % n;
    values[static_cast<std::size_t>(i)] = x < 14 ? 0.0F : x < 26 ? 10.0F : 13.0F;
    labels[static_cast<std::size_t>(i)] = x >= 15 && x < 27 ? 1 : 0;  // one voxel too far to the right
  }
  const RingForce ring = ring_force(values, grid, {}, labels);
  const std::vector<float>& force = ring.force;
  for (Index y = 0; y < n; ++y) {
    const auto row = static_cast<std::size_t>(n * y);
    EXPECT_GT(force[row + 13], 0);
    EXPECT_LT(force[row + 14], 0);
    EXPECT_LT(force[row + 25], 0);
    EXPECT_GT(force[row + 26], 0);
    EXPECT_GT(force[row + 5], 0) << "far outside";
    EXPECT_LT(force[row + 20], 0) << "far inside";
  }
  EXPECT_GE(ring.contrast, 3);  // of either side
  EXPECT_LE(ring.contrast, 10);
}

}  // namespace
}  // namespace csrbf::ring_force_test
