#include "csrbf/levelset/image/channel_contrast.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace csrbf::channel_contrast_test {
namespace {

// Channels of a noisy image: the first third of the voxels has mean `inside`, the others `outside`; the brightness of
// all channels together varies by `light`.
Volume<float> paint(const std::vector<double>& inside, const std::vector<double>& outside, double light) {
  VolumeLayout layout;
  layout.grid.size = {60, 50, 1};
  layout.grid.axes = 2;
  layout.components = std::ssize(inside);
  Volume<float> image(layout);
  std::mt19937 generator(2);
  std::normal_distribution<double> normal(0, 1);
  for (Index i = 0; i < 3000; ++i) {
    const double brightness = light * normal(generator);
    for (Index c = 0; c < layout.components; ++c)
      image.values[i * layout.components + c] =
          static_cast<float>((i < 1000 ? inside : outside)[c] + brightness + 0.2 * normal(generator));
  }
  return image;
}

TEST(ChannelContrast, IsTheDifferenceOfTheMeansOfTwoClasses) {
  const std::vector<double> w = channel_contrast(paint({5, 1, 3}, {1, 4, 3}, 0), {});
  ASSERT_EQ(w.size(), 3U);
  EXPECT_NEAR(std::abs(w[0]), 0.8, 0.02);
  EXPECT_NEAR(std::abs(w[1]), 0.6, 0.02);
  EXPECT_NEAR(w[2], 0, 0.02);
  EXPECT_LT(w[0] * w[1], 0);
  EXPECT_GT(w[0] + w[1] + w[2], 0);
}

TEST(ChannelContrast, SeesHuesWhoseBrightnessVaries) {
  const std::vector<double> w = channel_contrast(paint({5, 1}, {1, 5}, 1), {});
  EXPECT_NEAR(std::abs(w[0]), std::sqrt(0.5), 0.05);
  EXPECT_LT(w[0] * w[1], 0);
}

TEST(ChannelContrast, LeavesOutTheMaskAndWhatIsNotFinite) {
  Volume<float> image = paint({5, 1}, {1, 1}, 0);
  std::vector<std::uint8_t> mask(3000, 1);
  for (Index i = 2000; i < 3000; ++i) {
    mask[i] = 0;
    image.values[2 * i + 1] = 1000;
  }
  image.values[0] = std::numeric_limits<float>::quiet_NaN();
  const std::vector<double> w = channel_contrast(image, mask);
  EXPECT_NEAR(w[0], 1, 0.01);
}

TEST(ChannelContrast, OfEqualChannelsWeighsThemAlike) {
  Volume<float> image = paint({3, 3}, {1, 1}, 0);
  for (Index i = 0; i < 3000; ++i) image.values[2 * i + 1] = image.values[2 * i];
  const std::vector<double> w = channel_contrast(image, {});
  EXPECT_NEAR(w[0], w[1], 1e-6);
  EXPECT_NEAR(weigh_channels(image, w).values[7], image.values[14] * std::sqrt(2.0), 1e-5);
}

TEST(RootChannels, AreRootsOnTheScaleOfTheMaximum) {
  Volume<float> image = paint({3, 3}, {1, 1}, 0);
  for (float& x : image.values) x = std::clamp(x, 0.0F, 4.0F);
  image.values[5] = 4;
  image.values[6] = 1;
  image.values[8] = std::numeric_limits<float>::quiet_NaN();
  const Volume<float> roots = root_channels(image, {});
  EXPECT_NEAR(roots.values[5], 4, 1e-6);
  EXPECT_NEAR(roots.values[6], 2, 1e-6);
}

TEST(RootChannels, LeavesChannelsWithNegativeValuesAlone) {
  Volume<float> image = paint({3, 3}, {1, 1}, 0);
  image.values[5] = -1;
  image.values[6] = 2;
  EXPECT_EQ(root_channels(image, {}).values[6], 2);
  std::vector<std::uint8_t> mask(3000, 1);
  mask[2] = 0;
  EXPECT_NE(root_channels(image, mask).values[6], 2);
}

}  // namespace
}  // namespace csrbf::channel_contrast_test
