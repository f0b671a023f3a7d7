#include "csrbf/levelset/image/edgeless_share.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace csrbf::edgeless_share_test {
namespace {

constexpr Index n = 60;

struct Picture {
  Grid grid;
  std::vector<float> values;
  std::vector<std::uint8_t> labels, mask;

  // Dark up to x = 20, bright beyond, and a contour there and at x = `cut`.
  explicit Picture(Index cut) {
    grid.axes = 2;
    grid.size = {n, n, 1};
    for (Index i = 0; i < n * n; ++i) {
      values.push_back(i % n < 20 ? 0.0F : 1.0F);
      labels.push_back(i % n >= 20 && i % n < cut ? 1 : 0);
      mask.push_back(i % n < 30 ? 1 : 0);
    }
  }
};

TEST(EdgelessShare, IsThatOfContoursWithinARegion) {
  const Picture whole(n), cut(40);
  EXPECT_EQ(edgeless_share(whole.values, whole.labels, whole.grid, {}), 0);
  EXPECT_NEAR(edgeless_share(cut.values, cut.labels, cut.grid, {}), 0.5, 1e-12);
  EXPECT_EQ(edgeless_share(cut.values, cut.labels, cut.grid, cut.mask), 0);
  const std::vector<std::uint8_t> one(cut.labels.size(), 1);
  EXPECT_EQ(edgeless_share(cut.values, one, cut.grid, {}), 0);
}

TEST(BorderSharpness, IsTheShareOfAStepFromOneVoxelToTheNext) {
  Picture whole(n);
  EXPECT_NEAR(border_sharpness(whole.values, whole.labels, whole.grid, {}), 1, 1e-6);
  for (Index i = 0; i < n * n; ++i)
    whole.values[i] = std::clamp(0.25F * static_cast<float>(i % n) - 4.375F, 0.0F, 1.0F);  // over four voxels
  const double blurred = border_sharpness(whole.values, whole.labels, whole.grid, {});
  EXPECT_GT(blurred, 0.25);
  EXPECT_LT(blurred, 0.4);
  for (float& value : whole.values) value = -value;
  EXPECT_NEAR(border_sharpness(whole.values, whole.labels, whole.grid, {}), blurred, 1e-6);
}

// Half of the border up and blurred, half of it down and sharp: what all of it differs by nearly vanishes.
TEST(BorderSharpness, IsNoneWhereEdgesOfBothSignsCancel) {
  Picture whole(n);
  for (Index i = 0; i < n * n; ++i) {
    const float up = std::clamp(0.25F * static_cast<float>(i % n) - 4.375F, 0.0F, 1.0F);
    whole.values[i] = i / n < n / 2 ? up : i % n < 20 ? 0.0F : -0.8F;
  }
  EXPECT_EQ(border_sharpness(whole.values, whole.labels, whole.grid, {}), 0) << "says nothing";
}

}  // namespace
}  // namespace csrbf::edgeless_share_test
