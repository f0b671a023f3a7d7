#include "csrbf/levelset/regions/intensity_histogram.hpp"

#include "core/error_testing.hpp"
#include "csrbf/core/parallel.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace csrbf::intensity_histogram_test {
namespace {

constexpr double rounding = 1e-12;

std::vector<float> normal_values(std::size_t n, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  std::vector<float> values(n);
  for (float& value : values) value = normal(random);
  return values;
}

TEST(IntensityBins, OfGreyLevelsHaveOneLevelEach) {
  std::vector<float> values(256);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i);
  const IntensityBins bins = choose_bins(values);
  EXPECT_EQ(bins.lo, -.5);
  EXPECT_EQ(bins.hi, 255.5);
  ASSERT_EQ(bins.count, 256);
  for (Index k = 0; k < 256; ++k) EXPECT_EQ(bins.index(static_cast<double>(k)), k);
}

TEST(IntensityBins, OfManyGreyLevelsHaveEquallyManyLevelsEach) {
  const std::vector<float> values = {-1024, 17, 3071};  // 4096 levels
  const IntensityBins bins = choose_bins(values);
  EXPECT_EQ(bins.lo, -1024.5);
  EXPECT_EQ(bins.width(), 16);
  EXPECT_EQ(bins.count, 256);
}

TEST(IntensityBins, OfFewGreyLevelsAreFew) {
  const IntensityBins bins = choose_bins(std::vector<float>{3, 4, 7});
  EXPECT_EQ(bins.count, 5);
  EXPECT_EQ(bins.center(4), 7);
}

TEST(IntensityBins, HaveTheExtremesAtTheCentresOfTheEndBins) {
  const IntensityBins bins = choose_bins(std::vector<float>{.25f, .3f, .75f}, 101);
  EXPECT_NEAR(bins.center(0), .25, rounding);
  EXPECT_NEAR(bins.center(100), .75, rounding);
}

TEST(IntensityBins, AreTheLevelsOfCounts) {
  std::mt19937 random(11);
  std::poisson_distribution<int> counts(3);
  std::vector<float> photons, rounded, spread = normal_values(2000, 12);
  int most = 0;
  for (int i = 0; i < 2000; ++i) {
    const int count = counts(random);
    most = std::max(most, count);
    photons.push_back(1e-6f * (7 + .37f * static_cast<float>(count)));
    rounded.push_back(std::round(455.3f * static_cast<float>(count)));
  }
  for (const std::vector<float>& values : {photons, rounded}) {
    const IntensityBins bins = choose_bins(values);
    EXPECT_EQ(bins.count, most + 1);
    EXPECT_NEAR(bins.center(0), static_cast<double>(*std::min_element(values.begin(), values.end())),
                bins.width() * .01);
  }
  EXPECT_EQ(choose_bins(spread).count, 256);
  EXPECT_EQ(choose_bins(std::vector<float>{.25f, .3f, .75f}).count, 256);  // too few to tell
}

// As in images of 8 bits that are made of counts.
TEST(IntensityBins, AreLevelsThatAreRoundedAndClipped) {
  std::mt19937 random(13);
  std::poisson_distribution<int> counts(3);
  std::vector<float> values;
  for (int i = 0; i < 5000; ++i)
    values.push_back(std::min(255.0f, std::round(23.4f * static_cast<float>(counts(random)) + 12.75f)));
  const IntensityBins bins = choose_bins(values);
  EXPECT_EQ(bins.count, 11);
  EXPECT_NEAR(bins.width(), 23.4, 0.1);
  for (int count = 0; count <= 10; ++count) EXPECT_EQ(bins.index(23.4 * count + 12.75), count);
}

TEST(IntensityBins, MoveAndScaleWithTheIntensities) {
  const std::vector<float> values = normal_values(5000, 1);
  std::vector<float> changed = values;
  for (float& value : changed) value = 4 * value + 16;  // exact but for the rounding of the sum
  const IntensityBins bins = choose_bins(values);
  const IntensityBins moved = choose_bins(changed);
  EXPECT_NEAR(moved.lo, 4 * bins.lo + 16, 1e-5);
  EXPECT_NEAR(moved.hi, 4 * bins.hi + 16, 1e-5);
}

TEST(IntensityBins, AreNotWidenedByOutliers) {
  std::vector<float> values = normal_values(100000, 2);
  const IntensityBins clean = choose_bins(values);
  values[500] = 1e6f;
  values[900] = -1e30f;
  const IntensityBins bins = choose_bins(values);
  // Quantiles .001 and .999 of a normal distribution are 6.18 apart: the bins reach 3 times that beyond them.
  EXPECT_NEAR(bins.hi, 3.09 + 3 * 6.18, .5);
  EXPECT_NEAR(bins.lo, -bins.hi, .5);
  EXPECT_LT(clean.hi, 6);
  EXPECT_EQ(bins.index(1e6), bins.count - 1);
  EXPECT_EQ(bins.index(-1e30), 0);
}

TEST(IntensityBins, KeepASmallButBrightObjectApart) {
  std::vector<float> values = normal_values(100000, 3);
  for (std::size_t i = 0; i < 50; ++i) values[2000 * i] = 1000 + values[2000 * i];
  const IntensityBins bins = choose_bins(values);
  EXPECT_EQ(bins.index(1000), bins.count - 1);
  EXPECT_LT(bins.index(5), bins.count / 2 + 40);
}

TEST(IntensityBins, AreThoseOfTheVoxelsInTheMask) {
  const std::vector<float> values = {0, 1, 2, std::numeric_limits<float>::quiet_NaN(), 100};
  const IntensityBins bins = choose_bins(values, 256, std::vector<std::uint8_t>{1, 1, 1, 0, 0});
  EXPECT_EQ(bins.lo, -.5);
  EXPECT_EQ(bins.hi, 2.5);
}

TEST(BinIndices, AreThoseOfEveryValueByItself) {
  const std::vector<float> values = normal_values(10007, 4);
  IntensityBins bins = choose_bins(values);
  bins.hi = 2;  // some values lie beyond
  bins.lo = -1;
  const std::vector<std::uint8_t> indices = bin_indices(values, bins);
  for (std::size_t i = 0; i < values.size(); ++i)
    EXPECT_EQ(indices[i], bins.index(static_cast<double>(values[i]))) << i;
}

TEST(Histogram, HasTheMomentsOfItsBins) {
  Histogram histogram(IntensityBins{0, 4, 4});
  histogram.add(.2);
  histogram.add(1.9, 2);
  histogram.add(9);
  EXPECT_EQ(histogram.counts, (std::vector<double>{1, 2, 0, 1}));
  EXPECT_EQ(histogram.total(), 4);
  EXPECT_NEAR(histogram.mean(), (.5 + 2 * 1.5 + 3.5) / 4, rounding);
  EXPECT_NEAR(histogram.moment(2, 1), (.25 + 2 * .25 + 6.25) / 4, rounding);
  EXPECT_NEAR(histogram.quantile(.5), 1.5, rounding);
  EXPECT_NEAR(histogram.quantile(1), 4, rounding);
}

TEST(Histogram, IsInTheMiddleWhenEmpty) {
  const Histogram histogram(IntensityBins{2, 4, 8});
  EXPECT_EQ(histogram.mean(), 3);
  EXPECT_EQ(histogram.quantile(.3), 3);
  EXPECT_EQ(histogram.moment(2, 0), 0);
}

TEST(RegionHistograms, CountTheVoxelsOfEachRegion) {
  const std::vector<float> values = normal_values(300001, 5);
  const IntensityBins bins = choose_bins(values, 100);
  std::vector<std::uint8_t> labels(values.size());
  std::mt19937 random(6);
  for (std::uint8_t& label : labels) label = static_cast<std::uint8_t>(random() % 4);
  labels[7] = 255;
  std::vector<Histogram> expected(3, Histogram(bins));
  for (std::size_t i = 0; i < values.size(); ++i)
    if (labels[i] < 3) expected[labels[i]].add(static_cast<double>(values[i]));
  const std::vector<Histogram> found = region_histograms(bin_indices(values, bins), labels, 3, bins);
  ASSERT_EQ(found.size(), 3U);
  for (std::size_t r = 0; r < 3; ++r) EXPECT_EQ(found[r].counts, expected[r].counts);
}

TEST(RegionHistograms, OfOneRegionAreThatOfTheImage) {
  const std::vector<float> values = normal_values(1000, 7);
  const IntensityBins bins = choose_bins(values);
  const std::vector<std::uint8_t> labels(values.size(), 0);
  EXPECT_EQ(histogram_of(values, bins).counts,
            region_histograms(bin_indices(values, bins), labels, 1, bins).front().counts);
  EXPECT_EQ(histogram_of(values, bins).total(), 1000);
}

TEST(RegionHistograms, DoNotDependOnTheNumberOfThreads) {
  const std::vector<float> values = normal_values(1000003, 8);
  const auto counts = [&](int threads) {
    set_thread_count(threads);
    const IntensityBins bins = choose_bins(values);
    auto result = histogram_of(values, bins).counts;
    result.push_back(bins.lo);
    set_thread_count(0);
    return result;
  };
  EXPECT_EQ(counts(1), counts(3));
}

TEST(IntensityBins, RejectImagesWithoutIntensities) {
  const std::vector<float> two = {1, 2};
  EXPECT_EQ(invalid_input_message([] {
              choose_bins(std::vector<float>{5, 5, 5});
            }),
            "choose_bins: values = 5: must not be constant: regions of one intensity cannot be told apart");
  EXPECT_EQ(invalid_input_message([] { choose_bins({}); }),
            "choose_bins: number of values = 0: must be positive: the image or its mask is empty");
  EXPECT_THROW(choose_bins(two, 256, std::vector<std::uint8_t>{0, 0}), InvalidInput);
  EXPECT_THROW(choose_bins(two, 256, std::vector<std::uint8_t>{1}), InvalidInput);
  EXPECT_THROW(choose_bins(two, 257), InvalidInput);
  EXPECT_THROW(choose_bins(two, 1), InvalidInput);
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    EXPECT_EQ(invalid_input_message([&] {
                choose_bins(std::vector<float>{1, bad, 2});
              }),
              "choose_bins: values = NaN or infinity: must be finite: replace or mask these voxels");
  }
}

TEST(RegionHistograms, RejectWhatDoesNotFit) {
  const IntensityBins bins{0, 1, 4};
  const std::vector<std::uint8_t> three(3, 0);
  const std::vector<std::uint8_t> two(2, 0);
  EXPECT_THROW(region_histograms(three, two, 2, bins), InvalidInput);
  EXPECT_THROW(region_histograms(three, three, 0, bins), InvalidInput);
  EXPECT_THROW(region_histograms(std::vector<std::uint8_t>{0, 4, 1}, three, 1, bins), InvalidInput);
  EXPECT_THROW(bin_indices(std::vector<float>{1}, IntensityBins{0, 1, 257}), InvalidInput);
  EXPECT_THROW(histogram_of(std::vector<float>{1}, IntensityBins{1, 1, 8}), InvalidInput);
}

}  // namespace
}  // namespace csrbf::intensity_histogram_test
