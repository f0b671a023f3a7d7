#include "csrbf/levelset/partition/blurred_classes.hpp"

#include "csrbf/levelset/segment.hpp"
#include "levelset/levelset_testing.hpp"

#include <gtest/gtest.h>

namespace csrbf::blurred_classes_test {
namespace {

// Values from 0 to 1 with noise, and the classes of the values.
TestImage image_of(const std::function<double(const Point<3>&)>& value, double noise) {
  TestImage image{square_grid(128), {}, {}};
  std::mt19937 random(2);
  std::normal_distribution<double> normal(0, noise);
  const Points<3> centers = image.grid.centers<3>();
  for (Index i = 0; i < image.grid.voxels(); ++i) {
    const double v = value(centers.col(i));
    image.truth.push_back(static_cast<unsigned char>(v < 1.0 / 3 ? 0 : v < 2.0 / 3 ? 1 : 2));
    image.values.push_back(static_cast<float>(v + normal(random)));
  }
  return image;
}

// Folds a few voxels wide that grow into each other.
double folds(const Point<3>& p) {
  return 0.5 + 0.25 * (std::sin(p[0] * 0.9 + 2 * std::sin(p[1] * 0.1)) + std::sin(p[1] * 0.7));
}
double discs(const Point<3>& p) {
  const double r = std::hypot(p[0] - 64, p[1] - 64);
  return r < 25 ? 1 : r < 50 ? 0.5 : 0;
}

double share_right(const std::vector<std::uint8_t>& labels, const TestImage& image) {
  double right = 0;
  for (std::size_t i = 0; i < labels.size(); ++i) right += labels[i] == image.truth[i] ? 1 : 0;
  return right / static_cast<double>(labels.size());
}

std::vector<std::uint8_t> nothing(std::span<const float> values) {
  return std::vector<std::uint8_t>(values.size(), 1);
}

// Of two regions, whose means vary in that way.
Partition found_labels(std::vector<std::uint8_t> labels, MeanShape shape = MeanShape::constant) {
  Partition found;
  found.labels = std::move(labels);
  found.model = {shape};
  return found;
}

TEST(BlurredClasses, AreTakenWhereTheyFollowTheImageBetter) {
  const TestImage image = image_of(folds, 0.15);
  const std::optional<BlurredClasses> found = blurred_classes(image.values, image.grid, {}, 3, {}, nothing);
  ASSERT_TRUE(found);
  EXPECT_GE(found->deviation, 0.7);
  EXPECT_GT(share_right(found->labels, image), 0.8);
  const auto right = [&](std::span<const float>) {
    return std::vector<std::uint8_t>(image.truth.begin(), image.truth.end());
  };
  EXPECT_FALSE(blurred_classes(image.values, image.grid, {}, 3, {}, right));
}

double one_disc(const Point<3>& p) {
  return std::hypot(p[0] - 64, p[1] - 64) < 25 ? 1.0 : 0.0;
}

TEST(BlurredClasses, OfTwoRegionsAreWideAndWorthIt) {
  const TestImage image = image_of(one_disc, 2), noise = image_of([](const Point<3>&) { return 0.0; }, 2);
  const std::vector<std::uint8_t> none(image.values.size(), 0);
  const std::optional<BlurredClasses> found = blurred_classes(image.values, image.grid, {}, 2, found_labels(none), {});
  ASSERT_TRUE(found);
  EXPECT_GT(found->deviation, 2);
  EXPECT_FALSE(blurred_classes(noise.values, noise.grid, {}, 2, found_labels(none), {}));
}

TEST(BlurredClasses, OfTwoRegionsAreTakenOffLight) {
  const TestImage image = image_of(one_disc, 0.8);
  TestImage lit = image;
  for (Index i = 0; i < image.grid.voxels(); ++i) lit.values[i] += 0.05F * static_cast<float>(i % 128);
  std::vector<std::uint8_t> none(image.values.size(), 0);
  none[0] = 1;
  const std::optional<BlurredClasses> found =
      blurred_classes(lit.values, lit.grid, {}, 2, found_labels(none, MeanShape::linear), {});
  ASSERT_TRUE(found);
  EXPECT_NE(found->light, MeanShape::constant);
  double right = 0;
  for (std::size_t i = 0; i < found->labels.size(); ++i) right += (found->labels[i] != 0) == (image.truth[i] != 0);
  EXPECT_GT(right / static_cast<double>(image.truth.size()), 0.93);
}

// Of a region with more noise the rest of its noise would tell classes of both images apart.
TEST(BlurredClasses, OfTwoRegionsLeaveThemTheirNoise) {
  TestImage image = image_of(one_disc, 0.5);
  for (std::size_t i = 0; i < image.values.size(); ++i) {
    image.values[i] -= image.truth[i] != 0 ? 1.0F : 0.0F;
    image.values[i] *= image.truth[i] != 0 ? 3.0F : 1.0F;
  }
  std::vector<std::uint8_t> labels(image.truth.begin(), image.truth.end());
  for (std::uint8_t& label : labels) label = label != 0 ? 1 : 0;
  EXPECT_FALSE(blurred_classes(image.values, image.grid, {}, 2, found_labels(labels), {}));
}

TEST(BlurredClasses, AreOfWhatTheMaskLeaves) {
  TestImage image = image_of(folds, 0.15);
  std::vector<std::uint8_t> mask(image.values.size(), 1);
  for (std::size_t i = 0; i < 4000; ++i) {
    mask[i] = 0;
    image.values[i] = 1000;
  }
  const std::optional<BlurredClasses> found = blurred_classes(image.values, image.grid, mask, 3, {}, nothing);
  ASSERT_TRUE(found);
  double right = 0;
  for (std::size_t i = 4000; i < mask.size(); ++i) right += found->labels[i] == image.truth[i] ? 1 : 0;
  EXPECT_GT(right / static_cast<double>(mask.size() - 4000), 0.8);
}

TEST(BlurredClasses, AreToldBySegmentOfTissues) {
  const auto segmented = [](const TestImage& image, SegmentEnergy energy = SegmentEnergy::automatic) {
    VolumeLayout layout;
    layout.grid = image.grid;
    Volume<float> volume(layout);
    volume.values = image.values;
    return segment<2>(volume, {.energy = energy, .regions = 3});
  };
  const TestImage tissues = image_of(folds, 0.15), shapes = image_of(discs, 0.35);
  const Segmentation<2> found = segmented(tissues);
  EXPECT_TRUE(found.report.blur);
  EXPECT_EQ(found.report.options.center_spacing, 1);
  EXPECT_GT(share_right(found.labels, tissues), 0.8);
  EXPECT_GT(share_right(segmented(shapes).labels, shapes), 0.98);
  // Means are all that more than two regions are described by: to give them changes nothing.
  EXPECT_GT(share_right(segmented(tissues, SegmentEnergy::chan_vese).labels, tissues), 0.8);
  EXPECT_GT(share_right(segmented(shapes, SegmentEnergy::chan_vese).labels, shapes), 0.98);
}

}  // namespace
}  // namespace csrbf::blurred_classes_test
