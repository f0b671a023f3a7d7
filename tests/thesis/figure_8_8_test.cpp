#include "thesis/figure_8_8.hpp"

#include <gtest/gtest.h>

namespace csrbf::thesis::figure_8_8_test {
namespace {

// 64 voxels: struts of 5 voxels; with 48 the smallest of them break.
TEST(Figure_8_8, TheBoneHasTheTopologyOfItsTruth) {
  constexpr Index n = 64;
  const SegmentedBone run = bone_by_segment(n, 20);
  const Topology exact = bone_topology(n);
  EXPECT_GT(run.dice, 0.985);
  EXPECT_TRUE(run.topology.watertight());
  EXPECT_EQ(run.topology.components, exact.components);
  EXPECT_EQ(run.topology.euler, exact.euler);
}

TEST(Figure_8_8, CollocationFindsTheBoneToo) {
  EXPECT_GT(bone_by_collocation(32, 16, 20).dice, 0.95);
}

}  // namespace
}  // namespace csrbf::thesis::figure_8_8_test
