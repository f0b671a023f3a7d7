#include "csrbf/implicit/render/light_pattern.hpp"

#include "csrbf/implicit/mesh/triangle_geometry.hpp"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <set>

namespace csrbf::light_pattern_test {
namespace {

constexpr double rounding = 1e-12;

TEST(LightPattern, EveryEightByEightSquareHasAllClasses) {
  for (const auto& corner : {std::array{0, 0}, std::array{3, 5}, std::array{-4, -7}}) {
    std::set<int> seen;
    for (int y = 0; y < 8; ++y)
      for (int x = 0; x < 8; ++x) seen.insert(LightPattern::class_of(corner[0] + x, corner[1] + y));
    EXPECT_EQ(seen.size(), 64U);
    EXPECT_EQ(*seen.begin(), 0);
    EXPECT_EQ(*seen.rbegin(), 63);
  }
}

TEST(LightPattern, SkyRaysFollowTheCosine) {
  const LightPattern pattern(4);
  double height = 0, second = 0;
  Point<3> mean = Point<3>::Zero();
  for (int c = 0; c < 64; ++c) {
    for (int ray = 0; ray < 4; ++ray) {
      const auto& [direction, reach] = pattern.sky(c, ray);
      EXPECT_NEAR(direction.norm(), 1, rounding);
      EXPECT_GE(direction[2], 0);
      EXPECT_GE(reach, 0.25);
      EXPECT_LE(reach, 1);
      mean += direction / 256;
      height += direction[2] / 256;
      second += direction[2] * direction[2] / 256;
    }
  }
  // With density cos / pi the mean of z is 2/3 and that of z^2 is 1/2. 256 points of a net miss by about 1/256.
  const double discrepancy = 2.0 / 256;
  EXPECT_NEAR(height, 2.0 / 3, discrepancy);
  EXPECT_NEAR(second, 0.5, discrepancy);
  EXPECT_LT(mean.head<2>().norm(), discrepancy);
}

TEST(LightPattern, LampPointsFillTheUnitDisk) {
  const LightPattern pattern(1);
  double second = 0;
  Point<2> mean = Point<2>::Zero();
  for (int c = 0; c < 64; ++c) {
    EXPECT_LE(pattern.lamp(c).norm(), 1 + rounding);
    mean += pattern.lamp(c) / 64;
    second += pattern.lamp(c).squaredNorm() / 64;
  }
  EXPECT_LT(mean.norm(), 2.0 / 64);
  EXPECT_NEAR(second, 0.5, 2.0 / 64);
}

TEST(LightPattern, TangentsCompleteARightHandedFrame) {
  for (const Point<3>& n : {Point<3>(0, 0, 1), Point<3>(1, 0, 0), Point<3>(-0.6, 0, 0.8), Point<3>(0, -1, 0)}) {
    Eigen::Matrix3d frame;
    const auto [t1, t2] = tangents(n);
    frame << t1, t2, n;
    EXPECT_TRUE((frame.transpose() * frame).isIdentity(rounding));
    EXPECT_TRUE(t1.cross(t2).isApprox(n, rounding));
  }
}

}  // namespace
}  // namespace csrbf::light_pattern_test
