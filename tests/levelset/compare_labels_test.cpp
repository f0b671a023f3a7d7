#include "csrbf/levelset/compare_labels.hpp"

#include "core/error_testing.hpp"
#include "csrbf/core/percentile.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <random>

namespace csrbf::compare_labels_test {
namespace {

using Labels = Volume<float>;
using LabelAt = std::function<int(Index x, Index y, Index z)>;

constexpr double float_rounding = 1e-6;

Labels labels(const std::array<Index, 3>& size, const LabelAt& at, const Point<3>& spacing = Point<3>::Ones()) {
  VolumeLayout layout;
  layout.grid.size = size;
  layout.grid.axes = size[2] > 1 ? 3 : 2;
  layout.grid.spacing = spacing;
  Labels volume(layout);
  for (Index z = 0; z < size[2]; ++z)
    for (Index y = 0; y < size[1]; ++y)
      for (Index x = 0; x < size[0]; ++x) volume.values[layout.grid.index(x, y, z)] = static_cast<float>(at(x, y, z));
  return volume;
}

LabelAt box(Index from, Index to, int label = 1) {
  return [=](Index x, Index y, Index) { return x >= from && x < to && y >= 2 && y < 12 ? label : 0; };
}

std::vector<Point<3>> border_of(const Labels& volume, float label) {
  std::vector<Point<3>> points;
  const auto& size = volume.grid.size;
  const auto holds = [&](Index x, Index y, Index z) {
    return x >= 0 && y >= 0 && z >= 0 && x < size[0] && y < size[1] && z < size[2] &&
           volume.values[volume.grid.index(x, y, z)] == label;
  };
  for (Index z = 0; z < size[2]; ++z)
    for (Index y = 0; y < size[1]; ++y)
      for (Index x = 0; x < size[0]; ++x) {
        if (!holds(x, y, z)) continue;
        const bool within = holds(x - 1, y, z) && holds(x + 1, y, z) && holds(x, y - 1, z) && holds(x, y + 1, z) &&
                            (size[2] == 1 || (holds(x, y, z - 1) && holds(x, y, z + 1)));
        const Point<3> voxel(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z));
        if (!within) points.emplace_back(volume.grid.spacing.cwiseProduct(voxel));
      }
  return points;
}

double brute_force_distance95(const std::vector<Point<3>>& from, const std::vector<Point<3>>& to) {
  std::vector<double> distances;
  for (const Point<3>& p : from) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Point<3>& q : to) nearest = std::min(nearest, (p - q).norm());
    distances.push_back(nearest);
  }
  return percentile(distances, 0.95);
}

TEST(CompareLabels, OfEqualImagesFindsNoDifference) {
  const Labels image = labels({20, 15, 1}, box(3, 9));
  const LabelsComparison same = compare_labels(image, image);
  EXPECT_EQ(same.dice, 1);
  EXPECT_EQ(same.jaccard, 1);
  EXPECT_EQ(same.hausdorff95, 0);
  ASSERT_EQ(same.labels.size(), 1U);
  EXPECT_EQ(same.labels[0].label, 1);
  EXPECT_EQ(same.labels[0].voxels, 60);
  EXPECT_EQ(same.labels[0].reference_voxels, 60);
}

TEST(CompareLabels, OfShiftedBoxesIsExact) {
  // 6 x 10 voxels shifted by 2: 40 are common. The ten border voxels of the end that leaves are 2 steps away.
  const Point<3> spacing(0.7, 3, 1);
  const LabelsComparison c =
      compare_labels(labels({20, 15, 1}, box(3, 9), spacing), labels({20, 15, 1}, box(5, 11), spacing));
  EXPECT_DOUBLE_EQ(c.dice, 80. / 120);
  EXPECT_DOUBLE_EQ(c.jaccard, 40. / 80);
  EXPECT_NEAR(c.hausdorff95, 2 * 0.7, float_rounding);
}

TEST(CompareLabels, SumsOverLabelsAndTakesTheLargestDistance) {
  const auto two = [](Index end1, Index begin2) {
    return [=](Index x, Index y, Index z) { return box(1, end1)(x, y, z) + box(begin2, 19, 7)(x, y, z); };
  };
  const LabelsComparison c = compare_labels(labels({20, 15, 1}, two(6, 12)), labels({20, 15, 1}, two(5, 15)));
  ASSERT_EQ(c.labels.size(), 2U);
  EXPECT_EQ(c.labels[0].label, 1);
  EXPECT_EQ(c.labels[1].label, 7);
  EXPECT_DOUBLE_EQ(c.labels[0].dice, 80. / 90);
  EXPECT_DOUBLE_EQ(c.labels[1].dice, 80. / 110);
  EXPECT_DOUBLE_EQ(c.dice, 160. / 200);
  EXPECT_DOUBLE_EQ(c.jaccard, 80. / 120);
  EXPECT_EQ(c.labels[0].hausdorff95, 1);
  EXPECT_EQ(c.labels[1].hausdorff95, 3);
  EXPECT_EQ(c.hausdorff95, 3);
}

TEST(CompareLabels, CanTakeAllLabelsForTheInside) {
  const Labels one = labels({20, 15, 1}, box(3, 9, 255)), other = labels({20, 15, 1}, box(3, 9, 1));
  EXPECT_EQ(compare_labels(one, other).dice, 0);
  EXPECT_EQ(compare_labels(one, other, {.inside_only = true}).dice, 1);
}

TEST(CompareLabels, IsInfinitelyFarFromALabelThatIsMissing) {
  const Labels none = labels({20, 15, 1}, box(0, 0)), some = labels({20, 15, 1}, box(3, 9));
  for (const LabelsComparison& c : {compare_labels(none, some), compare_labels(some, none)}) {
    EXPECT_EQ(c.dice, 0);
    EXPECT_EQ(c.jaccard, 0);
    EXPECT_EQ(c.hausdorff95, std::numeric_limits<double>::infinity());
  }
  const LabelsComparison empty = compare_labels(none, none);
  EXPECT_EQ(empty.dice, 1);
  EXPECT_EQ(empty.hausdorff95, 0);
  EXPECT_TRUE(empty.labels.empty());
}

TEST(CompareLabels, AgreesWithAllPairsOfBorderVoxels) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> shift(-3, 3);
  for (const std::array<Index, 3>& size : {std::array<Index, 3>{40, 33, 1}, std::array<Index, 3>{17, 20, 15}}) {
    const Point<3> spacing(0.8, 1.1, 2.5);
    const auto ball = [&](double radius) {
      const Point<3> center(static_cast<double>(size[0]) / 2 + shift(random),
                            static_cast<double>(size[1]) / 2 + shift(random), static_cast<double>(size[2] / 2));
      return [=](Index x, Index y, Index z) {
        const Point<3> p(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z));
        return (p - center).norm() < radius ? 2 : 0;
      };
    };
    const Labels a = labels(size, ball(6), spacing), b = labels(size, ball(9), spacing);  // the second leaves the image
    const auto of_a = border_of(a, 2), of_b = border_of(b, 2);
    const double expected = std::max(brute_force_distance95(of_a, of_b), brute_force_distance95(of_b, of_a));
    EXPECT_NEAR(compare_labels(a, b).hausdorff95, expected, float_rounding * expected);
    EXPECT_EQ(compare_labels(a, b).hausdorff95, compare_labels(b, a).hausdorff95);
    EXPECT_EQ(compare_labels(a, b).dice, compare_labels(b, a).dice);
  }
}

TEST(CompareLabels, KnowsTheSpacesOfPatients) {
  Labels a = labels({20, 15, 1}, box(3, 9)), b = a;
  a.grid.space = Space::left_posterior_superior;
  a.grid.origin = {10, 20, 30};
  b.grid = in_space(a.grid, Space::right_anterior_superior);
  EXPECT_EQ(b.grid.origin, Point<3>(-10, -20, 30));
  EXPECT_EQ(compare_labels(a, b).dice, 1);
  b.grid.space = Space::left_posterior_superior;
  EXPECT_NE(invalid_input_message([&] { compare_labels(a, b); }), "");
}

TEST(CompareLabels, RefusesImagesThatDoNotMatch) {
  const Labels a = labels({20, 15, 1}, box(3, 9));
  const auto message = [&](const Labels& b) { return invalid_input_message([&] { compare_labels(a, b); }); };
  EXPECT_EQ(message(labels({20, 15, 2}, box(3, 9))),
            "compare_labels: size of the images = 20 x 15 and 20 x 15 x 2: must be the same; resample one of them");
  EXPECT_EQ(
      message(labels({20, 15, 1}, box(3, 9), Point<3>(1, 2, 1))),
      "compare_labels: distance of the same voxel in both images = 14: must be 0; spacing (1, 1, 1) and (1, 2, 1), "
      "origin (0, 0, 0) and (0, 0, 0) or the directions differ: resample one of the images");
  Labels b = a;
  b.grid.origin[0] = 0.009;
  EXPECT_EQ(message(b), "") << "rounding of headers";
  b.values[5] = 0.5F;
  EXPECT_EQ(message(b),
            "compare_labels: value in the reference = 0.5: labels are whole numbers; segment or round the image first");
  b.values[5] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_NE(message(b), "");
  VolumeLayout rgb = a;
  rgb.components = 3;
  EXPECT_EQ(message(Labels(rgb)),
            "compare_labels: components and frames of the reference = 3 and 1: a voxel must have one label");
  const Labels photo = labels({100, 100, 1}, [](Index x, Index y, Index) { return static_cast<int>(x + 100 * y); });
  EXPECT_EQ(invalid_input_message([&] { compare_labels(photo, photo); }),
            "compare_labels: labels = 4097: there may be 4096 at most; is one of the images no label image?");
}

}  // namespace
}  // namespace csrbf::compare_labels_test
