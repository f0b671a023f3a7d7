#include "thesis/figure_8_8.hpp"

#include <gtest/gtest.h>

namespace csrbf::thesis {
namespace {

// 64 voxels: struts of 5 voxels; with 48 the smallest of them break. Curvatures err by 5.6 % and 8.4 % with 72 voxels,
// as they grow with the length of a voxel.
TEST(Figure_8_8, TheBoneHasTheTopologyAndTheCurvaturesOfItsTruth) {
  constexpr Index n = 64;
  const SegmentedBone run = bone_by_segment(n, 20);
  const Topology exact = bone_topology(n);
  EXPECT_GT(run.dice, 0.985);
  EXPECT_TRUE(run.topology.watertight());
  EXPECT_EQ(run.topology.components, exact.components);
  EXPECT_EQ(run.topology.euler, exact.euler);
  const CurvatureErrors errors = curvature_errors(run, n);
  EXPECT_LT(errors.mean, 0.15);
  EXPECT_LT(errors.gaussian, 0.2);
  EXPECT_GT(errors.gaussian_correlation, 0.93);
}

TEST(Figure_8_8, CollocationFindsTheBoneToo) {
  EXPECT_GT(bone_by_collocation(32, 16, 20).dice, 0.95);
}

}  // namespace
}  // namespace csrbf::thesis
