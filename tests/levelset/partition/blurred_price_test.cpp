#include "csrbf/levelset/partition/blurred_price.hpp"

#include "csrbf/levelset/image/gaussian_blur.hpp"
#include "csrbf/levelset/partition/grained_partition.hpp"
#include "levelset/levelset_testing.hpp"

#include <gtest/gtest.h>

#include <random>

namespace csrbf {
namespace {

constexpr Index n = 128;
constexpr double length = 1.5;

struct Disc {
  Grid grid;
  std::vector<float> values;
  std::vector<std::uint8_t> truth;
};

struct Place {
  double x, y, radius;
};

// Of brightness 1 with blurred edges, in noise of that deviation that is blurred, too.
Disc disc(double blur, double noise, double noise_blur = 0, const std::vector<Place>& places = {{60, 66, 35}}) {
  Disc disc;
  disc.grid.axes = 2;
  disc.grid.size = {n, n, 1};
  std::mt19937 generator(5);
  std::normal_distribution<float> normal(0, 1);
  std::vector<float> z(static_cast<std::size_t>(n * n));
  double squares = 0;
  for (float& x : z) x = normal(generator);
  gaussian_blur(z, disc.grid.size, {noise_blur, noise_blur, 0});
  for (const float x : z) squares += static_cast<double>(x * x) / static_cast<double>(n * n);
  for (Index i = 0; i < n * n; ++i) {
    const bool in = std::any_of(places.begin(), places.end(), [&](const Place& place) {
      return std::hypot(static_cast<double>(i % n) - place.x, static_cast<double>(i / n) - place.y) < place.radius;
    });
    disc.truth.push_back(in ? 1 : 0);
    disc.values.push_back(in ? 1.0F : 0.0F);
  }
  gaussian_blur(disc.values, disc.grid.size, {blur, blur, 0});
  for (std::size_t i = 0; i < z.size(); ++i) disc.values[i] += static_cast<float>(noise / std::sqrt(squares)) * z[i];
  return disc;
}

PartitionPrice price_of(const Disc& disc) {
  const auto [lo, hi] = std::minmax_element(disc.values.begin(), disc.values.end());
  return {disc.values, static_cast<double>(*lo),         static_cast<double>(*hi), disc.grid,
          {},          contour_weight(disc.grid, length)};
}

double range(const Disc& disc) {
  const auto [lo, hi] = std::minmax_element(disc.values.begin(), disc.values.end());
  return static_cast<double>(*hi) - static_cast<double>(*lo);
}

TEST(BlurredPrice, PrefersTheTrueContourToOneThatFollowsTheNoiseOfABlurredBorder) {
  const Disc blurred = disc(2.8, 0.15);
  PartitionPrice price = price_of(blurred);
  std::vector<std::uint8_t> ragged(blurred.values.size());
  for (std::size_t i = 0; i < ragged.size(); ++i) ragged[i] = blurred.values[i] > 0.5F ? 1 : 0;
  EXPECT_LT(price.fit(ragged, {}) - price.measure(ragged).price,
            price.fit(blurred.truth, {}) - price.measure(blurred.truth).price);
  const BlurredFit wrong = fit_blurred(price, ragged, {}), right = fit_blurred(price, blurred.truth, {});
  EXPECT_GT(wrong.price - price.measure(ragged).price, right.price - price.measure(blurred.truth).price);
  EXPECT_EQ(right.blur, 2.8);
}

TEST(BlurredPrice, IsThatOfTheModelWithoutBlur) {
  const Disc sharp = disc(0, 0.2);
  PartitionPrice price = price_of(sharp);
  for (const bool own : {false, true}) {
    const PartitionModel model{MeanShape::constant, own};
    const BlurredFit fit = fit_blurred(price, sharp.truth, model);
    EXPECT_EQ(fit.blur, 0);
    EXPECT_NEAR(fit.price, price.fit(sharp.truth, model), 10);  // nats; levels are fitted once more
    double squares = 0;
    for (const float x : fit.residual) squares += static_cast<double>(x * x) / static_cast<double>(n * n);
    EXPECT_NEAR(squares, std::pow(0.2 / range(sharp), 2), 0.001);
  }
}

TEST(BlurredPrice, LabelsWithoutAPriceAreNotClear) {
  const Disc sharp = disc(0, 0.1);
  PartitionPrice price = price_of(sharp);
  EXPECT_TRUE(are_clear(price, sharp.truth, {}));
  std::vector<std::uint8_t> two_voxels(sharp.values.size(), 0);
  two_voxels[0] = two_voxels[1] = 1;
  EXPECT_TRUE(fit_blurred(price, two_voxels, {}).residual.empty());
  EXPECT_FALSE(are_clear(price, two_voxels, {}));
}

TEST(PlaceBlurredContour, MovesThatOfAThinBarWithoutNoiseToHalfItsHeightBeforeTheBlur) {
  Disc bar = disc(0, 0);
  for (Index i = 0; i < n * n; ++i) {
    const Index x = i % n, y = i / n;
    bar.truth[i] = y > 20 && y < 100 && std::abs(5 * x - 2 * y - 160) < 12 ? 1 : 0;
  }
  std::copy(bar.truth.begin(), bar.truth.end(), bar.values.begin());
  gaussian_blur(bar.values, bar.grid.size, {1.4, 1.4, 0});
  std::vector<std::uint8_t> labels;
  for (const float value : bar.values) labels.push_back(value > 0.25F ? 1 : 0);
  PartitionPrice price = price_of(bar);
  EXPECT_LT(dice(labels, bar.truth), 0.85);
  EXPECT_TRUE(place_blurred_contour(price, {}, labels));
  EXPECT_GT(dice(labels, bar.truth), 0.98);
}

TEST(PlaceBlurredContour, LeavesContoursThatDoNotExplainStructuresWithinRegions) {
  const Disc structured = disc(1.4, 0.15, 4);
  std::vector<std::uint8_t> labels;
  for (const float value : structured.values) labels.push_back(value > 0.35F ? 1 : 0);
  const std::vector<std::uint8_t> given = labels;
  PartitionPrice price = price_of(structured);
  EXPECT_GT(residual_correlation(fit_blurred(price, labels, {}).residual, structured.grid), independent);
  EXPECT_FALSE(place_blurred_contour(price, {}, labels));
  EXPECT_EQ(labels, given);
}

TEST(PlaceBlurredContour, LightDoesNotMoveIt) {
  Disc shaded = disc(1.4, 0.02);
  for (Index i = 0; i < n * n; ++i) shaded.values[i] += 0.04F * static_cast<float>(i % n);
  PartitionPrice price = price_of(shaded);
  std::vector<std::uint8_t> labels = shaded.truth;
  place_blurred_contour(price, {MeanShape::linear}, labels);
  EXPECT_GT(dice(labels, shaded.truth), 0.99);
}

TEST(GrainedPartition, DoesNotTakeBlurredNoiseForObjects) {
  const Disc grained = disc(0, 0.6, 1.5);
  PartitionPrice price = price_of(grained);
  EXPECT_LT(dice(find_partition(price).labels, grained.truth), 0.8);
  const Partition found = find_grained_partition(price);
  EXPECT_GT(dice(found.labels, grained.truth), 0.95);
  EXPECT_GT(price.grain(), 15);
}

TEST(GrainedPartition, KeepsSmallObjectsThatWereFoundWithoutTheGrain) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(0, 1);
  std::vector<Place> places(30);
  for (Place& place : places) place = {n * any(random), n * any(random), 2 + 2 * any(random)};
  const Disc dots = disc(0, 0.25, 0.8, places);
  PartitionPrice price = price_of(dots);
  EXPECT_GT(dice(find_grained_partition(price).labels, dots.truth), 0.92);
  EXPECT_GT(price.grain(), 5);
}

TEST(GrainedPartition, TakesIndependentVoxelsAsTheyAre) {
  const Disc sharp = disc(0, 0.6);
  PartitionPrice price = price_of(sharp), other = price_of(sharp);
  EXPECT_EQ(find_grained_partition(price).labels, find_partition(other).labels);
  EXPECT_EQ(price.grain(), 1);
}

}  // namespace
}  // namespace csrbf
