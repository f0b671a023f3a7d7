#include "csrbf/levelset/partition/large_partition.hpp"

#include "csrbf/levelset/contour/contour_energy.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace csrbf::large_partition_test {
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

struct Found {
  std::vector<std::uint8_t> labels;
  std::optional<LargePartition<3>> partition;
};

Found partition_of(const Picture& picture, std::span<const std::uint8_t> mask = {}, Index slab_voxels = 1 << 25) {
  SlicesInMemory image(picture.values, picture.grid.size[0] * picture.grid.size[1]);
  Found found;
  found.labels.resize(picture.values.size());
  found.partition = find_large_partition<3>(image, picture.grid, mask,
                                            {.weight = contour_weight(picture.grid, 1.5),
                                             .support = 2.5,
                                             .kernel = "wendland-c2",
                                             .slab_voxels = slab_voxels},
                                            found.labels, {});
  return found;
}

TEST(LargePartition, FindsABallAndALevelSetOfItsVolume) {
  const Picture picture = ball(0.08);
  const auto [labels, found] = partition_of(picture);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->converged);
  EXPECT_EQ(labels, picture.truth);
  EXPECT_EQ(found->outside, 0);
  EXPECT_EQ(found->voxels[1], std::count(labels.begin(), labels.end(), 1));
  EXPECT_NEAR(found->means[1], 1, 0.01);
  EXPECT_NEAR(found->deviations[0], 0.08, 0.004);
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
  const auto [labels, found] = partition_of(picture, mask);
  ASSERT_TRUE(found);
  Index wrong = 0;
  for (std::size_t i = 0; i < mask.size(); ++i) wrong += mask[i] != 0 && labels[i] != picture.truth[i] ? 1 : 0;
  EXPECT_EQ(wrong, 0);
}

TEST(LargePartition, IsTheSameSliceBySlice) {
  const Picture picture = ball(0.2);
  const auto [labels, whole] = partition_of(picture);
  for (const Index slab : {Index{1}, Index{7} * 40 * 36}) {
    SCOPED_TRACE(slab);
    const auto [cut_labels, cut] = partition_of(picture, {}, slab);
    ASSERT_TRUE(whole && cut);
    EXPECT_EQ(cut_labels, labels);
    EXPECT_EQ(cut->coefficients, whole->coefficients);
    constexpr double single = 1e-6;  // runs of voxels are summed in single precision
    EXPECT_NEAR(cut->energy.back(), whole->energy.back(), single);
    // Labels that are not kept are made again.
    SlicesInMemory image(picture.values, 40 * 36);
    std::vector<std::uint8_t> passed_on;
    const auto again = find_large_partition<3>(
        image, picture.grid, {},
        {.weight = contour_weight(picture.grid, 1.5), .support = 2.5, .kernel = "wendland-c2", .slab_voxels = slab}, {},
        [&](Index begin, std::span<const std::uint8_t> some, bool outside_is_1) {
          EXPECT_EQ(begin * 40 * 36, std::ssize(passed_on));
          EXPECT_FALSE(outside_is_1);
          passed_on.insert(passed_on.end(), some.begin(), some.end());
        });
    ASSERT_TRUE(again);
    EXPECT_EQ(passed_on, labels);
    EXPECT_EQ(again->coefficients, whole->coefficients);
  }
}

TEST(LargePartition, HasNoResultInMuchNoise) {
  EXPECT_FALSE(partition_of(ball(0.5)).partition);
}

}  // namespace
}  // namespace csrbf::large_partition_test
