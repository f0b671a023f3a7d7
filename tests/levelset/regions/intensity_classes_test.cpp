#include "csrbf/levelset/regions/intensity_classes.hpp"

#include "core/error_testing.hpp"

#include <gtest/gtest.h>

#include <random>

namespace csrbf::intensity_classes_test {
namespace {

constexpr double rounding = 1e-9;

Histogram random_histogram(Index bins, unsigned seed) {
  std::mt19937 random(seed);
  Histogram histogram(IntensityBins{-1, 2, bins});
  for (double& count : histogram.counts) count = random() % 3 == 0 ? 0 : static_cast<double>(random() % 50);
  histogram.counts.front() = 3;
  histogram.counts.back() = 5;
  return histogram;
}

// Sum of count (x - mean)^2 over the bins begin to end - 1, from the definition.
double class_energy(const Histogram& histogram, Index begin, Index end) {
  Histogram part(histogram.bins);
  for (auto k = static_cast<std::size_t>(begin); k < static_cast<std::size_t>(end); ++k)
    part.counts[k] = histogram.counts[k];
  return part.total() > 0 ? part.total() * part.moment(2, part.mean()) : 0;
}

// Least energy of all ways to cut the bins from `begin` on into `classes` intervals.
double least_energy(const Histogram& histogram, Index begin, Index classes) {
  if (classes == 1) return class_energy(histogram, begin, histogram.bins.count);
  double best = std::numeric_limits<double>::infinity();
  for (Index end = begin + 1; end < histogram.bins.count; ++end)
    best = std::min(best, class_energy(histogram, begin, end) + least_energy(histogram, end, classes - 1));
  return best;
}

TEST(IntensityClasses, OfTwoLevelsAreThese) {
  Histogram histogram(IntensityBins{0, 10, 10});
  histogram.add(2.5, 7);
  histogram.add(8.5, 2);
  const IntensityClasses classes = optimal_classes(histogram, 2);
  EXPECT_EQ(classes.means, (std::vector<double>{2.5, 8.5}));
  EXPECT_EQ(classes.thresholds, std::vector<double>{5.5});
  EXPECT_EQ(classes.energy, 0);
  EXPECT_EQ(optimal_classes(histogram, 2).thresholds[0], 5.5);
}

TEST(IntensityClasses, OfOneClassHaveItsMean) {
  const Histogram histogram = random_histogram(20, 1);
  const IntensityClasses classes = optimal_classes(histogram, 1);
  EXPECT_NEAR(classes.means.at(0), histogram.mean(), rounding);
  EXPECT_NEAR(classes.energy, class_energy(histogram, 0, 20), rounding);
  EXPECT_TRUE(classes.thresholds.empty());
}

TEST(IntensityClasses, SeparateTheMostVariance) {
  // Otsu: the threshold of greatest variance between the classes.
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Histogram histogram = random_histogram(64, seed);
    double most = -1;
    Index cut = 0;
    for (Index end = 1; end < 64; ++end) {
      double n = 0;
      double sum = 0;
      for (Index k = 0; k < end; ++k) {
        n += histogram.counts[k];
        sum += histogram.counts[k] * histogram.bins.center(k);
      }
      const double rest = histogram.total() - n;
      const double difference = sum / n - (histogram.total() * histogram.mean() - sum) / rest;
      if (n * rest * difference * difference <= most * (1 + rounding)) continue;
      most = n * rest * difference * difference;
      cut = end;
    }
    const double threshold = optimal_classes(histogram, 2).thresholds[0];
    for (Index k = 0; k < 64; ++k) {
      if (histogram.counts[k] <= 0) continue;
      EXPECT_EQ(histogram.bins.center(k) < threshold, k < cut) << seed;
    }
  }
}

TEST(IntensityClasses, HaveTheLeastEnergyOfAllPartitions) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Histogram histogram = random_histogram(18, seed);
    for (Index classes = 1; classes <= 5; ++classes)
      EXPECT_NEAR(optimal_classes(histogram, classes).energy, least_energy(histogram, 0, classes), rounding)
          << seed << " " << classes;
  }
}

TEST(IntensityClasses, AreThoseOfTheNearestMean) {
  // A stationary point of k-means whose energy is the one reported.
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Histogram histogram = random_histogram(256, seed);
    const IntensityClasses classes = optimal_classes(histogram, 4);
    std::vector<Histogram> parts(4, Histogram(histogram.bins));
    for (Index k = 0; k < 256; ++k) {
      const auto region = std::count_if(classes.thresholds.begin(), classes.thresholds.end(),
                                        [&](double t) { return t < histogram.bins.center(k); });
      parts[region].add(histogram.bins.center(k), histogram.counts[k]);
    }
    double energy = 0;
    for (std::size_t c = 0; c < 4; ++c) {
      EXPECT_NEAR(parts[c].mean(), classes.means[c], rounding);
      energy += parts[c].total() * parts[c].moment(2, parts[c].mean());
    }
    EXPECT_NEAR(energy, classes.energy, rounding * energy);
  }
}

TEST(IntensityClasses, OfAllLevelsHaveNoEnergy) {
  Histogram histogram(IntensityBins{0, 6, 6});
  for (const double value : {.5, 1.5, 4.5}) histogram.add(value, 3);
  const IntensityClasses classes = optimal_classes(histogram, 3);
  EXPECT_EQ(classes.energy, 0);
  ASSERT_EQ(classes.thresholds.size(), 2U);
  EXPECT_NEAR(classes.thresholds[0], 1, rounding);
  EXPECT_NEAR(classes.thresholds[1], 3, rounding);
}

TEST(IntensityClasses, RejectMoreClassesThanLevels) {
  Histogram histogram(IntensityBins{0, 6, 6});
  histogram.add(1);
  histogram.add(4);
  EXPECT_EQ(invalid_input_message([&] { optimal_classes(histogram, 3); }),
            "optimal_classes: classes = 3: must be 1 to the number of different intensities, 2");
  EXPECT_THROW(optimal_classes(histogram, 0), InvalidInput);
  EXPECT_THROW(optimal_classes(Histogram(IntensityBins{0, 6, 6}), 2), InvalidInput);
}

}  // namespace
}  // namespace csrbf::intensity_classes_test
