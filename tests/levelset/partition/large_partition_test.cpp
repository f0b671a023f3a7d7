#include "csrbf/levelset/partition/large_partition.hpp"

#include "csrbf/levelset/contour/contour_energy.hpp"

#include <gtest/gtest.h>

#include <random>

namespace csrbf {
namespace {

struct Picture {
  Grid grid;
  std::vector<float> values;
  std::vector<std::uint8_t> truth;
};

Picture ball(double noise) {
  Picture picture;
  picture.grid.size = {40, 36, 30};
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal(0, noise);
  for (Index z = 0; z < 30; ++z)
    for (Index y = 0; y < 36; ++y)
      for (Index x = 0; x < 40; ++x) {
        const Point<3> off(static_cast<double>(x) - 19, static_cast<double>(y) - 17, static_cast<double>(z) - 15);
        picture.truth.push_back(off.norm() < 11.3 ? 1 : 0);
        picture.values.push_back(static_cast<float>(picture.truth.back() + normal(random)));
      }
  return picture;
}

std::optional<LargePartition<3>> partition_of(const Picture& picture, std::span<const std::uint8_t> mask = {}) {
  return find_large_partition<3>(picture.values, picture.grid, mask, contour_weight(picture.grid, 1.5), 2.5,
                                 "wendland-c2", {});
}

TEST(LargePartition, FindsABallAndALevelSetOfItsVolume) {
  const Picture picture = ball(0.08);
  const std::optional<LargePartition<3>> found = partition_of(picture);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->converged);
  EXPECT_EQ(found->labels, picture.truth);
  EXPECT_NEAR(found->noise, 0.08, 0.004);
  // The level set is positive in the same voxels, but for some next to the contour.
  std::vector<std::uint8_t> inside(picture.values.size());
  update_labels(found->lattice, found->coefficients, inside.data());
  Index wrong = 0;
  for (std::size_t i = 0; i < inside.size(); ++i) wrong += inside[i] != picture.truth[i] ? 1 : 0;
  EXPECT_LT(wrong, 40);  // of 6000 inside
}

TEST(LargePartition, LeavesMaskedVoxelsOut) {
  Picture picture = ball(0.08);
  std::vector<std::uint8_t> mask(picture.values.size(), 1);
  for (std::size_t i = 0; i < mask.size() / 4; ++i) {
    mask[i] = 0;
    picture.values[i] = 1000;
  }
  const std::optional<LargePartition<3>> found = partition_of(picture, mask);
  ASSERT_TRUE(found);
  Index wrong = 0;
  for (std::size_t i = 0; i < mask.size(); ++i) wrong += mask[i] != 0 && found->labels[i] != picture.truth[i] ? 1 : 0;
  EXPECT_EQ(wrong, 0);
}

TEST(LargePartition, HasNoResultInMuchNoise) {
  EXPECT_FALSE(partition_of(ball(0.5)));
}

}  // namespace
}  // namespace csrbf
