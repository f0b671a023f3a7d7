#include "csrbf/levelset/regions/region_model.hpp"

#include "csrbf/levelset/regions/energy_table.hpp"
#include "csrbf/levelset/regions/gamma_functions.hpp"
#include "levelset/intensity_testing.hpp"

#include <gtest/gtest.h>

#include <functional>

namespace csrbf::region_model_test {
namespace {

constexpr std::size_t many = 200000;

RegionModel fit(IntensityLaw law, const std::vector<float>& values, const RegionModelOptions& options = {}) {
  return fit_region_model(law, histogram_of(values, choose_bins(values)), options);
}

double mean_of(const std::vector<float>& values, const std::function<double(double)>& f) {
  double sum = 0;
  for (const float value : values) sum += f(static_cast<double>(value));
  return sum / static_cast<double>(values.size());
}

double root(const std::function<double(double)>& increasing, double lo, double hi) {
  for (int i = 0; i < 60; ++i) (increasing(.5 * (lo + hi)) < 0 ? lo : hi) = .5 * (lo + hi);
  return .5 * (lo + hi);
}

double energy_of(const RegionModel& model, const Histogram& histogram) {
  return total_energy(energy_table(model, histogram.bins), histogram);
}

// Two or three bumps at random places.
Histogram random_histogram(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  Histogram histogram(IntensityBins{0, 1, 256});
  for (int bump = 0; bump < 2 + static_cast<int>(seed % 2); ++bump) {
    std::normal_distribution<double> normal(uniform(random), .02 + .1 * uniform(random));
    const int n = static_cast<int>(3000 * uniform(random));
    for (int i = 0; i < n; ++i) histogram.add(normal(random));
  }
  return histogram;
}

TEST(MomentRatio, HasTheShapesOfTheClosedForms) {
  EXPECT_NEAR(shape_of_moment_ratio(10. / 3), .5, 1e-10);
  EXPECT_NEAR(shape_of_moment_ratio(2), 1, 1e-10);
  EXPECT_NEAR(shape_of_moment_ratio(std::numbers::pi / 2), 2, 1e-10);
  EXPECT_NEAR(shape_of_moment_ratio(std::numbers::sqrt2), 4, 1e-9);
  EXPECT_EQ(shape_of_moment_ratio(4. / 3), 20);  // uniform: the shape is infinite
  EXPECT_EQ(shape_of_moment_ratio(1e6), .2);
}

class GeneralizedGaussian : public testing::TestWithParam<double> {};

TEST_P(GeneralizedGaussian, IsRecoveredFromSamples) {
  constexpr double tolerance = .02;  // one set of samples has a standard error of up to .012, for shape 10
  constexpr int sets = 4;
  double shape = 0;
  double scale = 0;
  double location = 0;
  for (unsigned seed = 1; seed <= sets; ++seed) {
    const RegionModel model =
        fit(IntensityLaw::generalized_gaussian, generalized_gaussian_samples(many, 3, GetParam(), seed));
    shape += model.shape / sets;
    scale += model.scale / sets;
    location += model.location / sets;
  }
  EXPECT_NEAR(shape / GetParam(), 1, tolerance);
  EXPECT_NEAR(scale / 3, 1, tolerance);
  EXPECT_NEAR(location / 3, 0, tolerance);
}

TEST_P(GeneralizedGaussian, IsRecoveredWhenMostOfTheTailsAreClipped) {
  // Bins from -2 to 3 only; the end bins count what lies beyond.
  const std::vector<float> values = generalized_gaussian_samples(many, 1.5, GetParam(), 2);
  const RegionModel model =
      fit_region_model(IntensityLaw::generalized_gaussian, histogram_of(values, IntensityBins{-2, 3, 256}));
  EXPECT_NEAR(model.shape / GetParam(), 1, .04);
  EXPECT_NEAR(model.location, 0, .04);
}

TEST_P(GeneralizedGaussian, SolvesTheLikelihoodEquationOfTheSamples) {
  // 1 + psi(1/b)/b - sum |x|^b log|x| / sum |x|^b + log((b/n) sum |x|^b) / b = 0 decreases where b is too great.
  const std::vector<float> values = generalized_gaussian_samples(20000, 1, GetParam(), 3);
  const double b = root(
      [&](double shape) {
        const double power = mean_of(values, [&](double x) { return std::pow(std::abs(x), shape); });
        const double product =
            mean_of(values, [&](double x) { return std::pow(std::abs(x), shape) * std::log(std::abs(x)); });
        return -(1 + digamma(1 / shape) / shape - product / power + std::log(shape * power) / shape);
      },
      .2, 20);
  const RegionModel model = fit(IntensityLaw::generalized_gaussian, values, {.location = 0.0});
  EXPECT_EQ(model.location, 0);
  EXPECT_NEAR(model.shape / b, 1, .01);  // what 256 bins do not resolve
}

INSTANTIATE_TEST_SUITE_P(OfShape, GeneralizedGaussian, testing::Values(.5, .7, 1, 2, 4, 10));

TEST(RegionModel, OfGaussianSamplesHasTheirMomentsAtAnyNumberOfBins) {
  std::mt19937_64 random(4);
  std::normal_distribution<float> normal(7, 2);
  std::vector<float> values(many);
  for (float& value : values) value = normal(random);
  const double mean = mean_of(values, [](double x) { return x; });
  const double variance = mean_of(values, [&](double x) { return (x - mean) * (x - mean); });
  for (const Index bins : {256, 16}) {
    const Histogram histogram = histogram_of(values, choose_bins(values, bins));
    const RegionModel model = fit_region_model(IntensityLaw::gaussian, histogram);
    EXPECT_NEAR(model.location, mean, .01) << bins;  // 2 / sqrt(many) = .004 is what another sample would change
    EXPECT_NEAR(model.scale / std::sqrt(variance), 1, .005) << bins;
  }
}

TEST(RegionModel, OfRayleighSamplesHasTheirMeanSquare) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<float> values(many);
  for (float& value : values) value = static_cast<float>(10 + 3 * std::sqrt(-2 * std::log(1 - uniform(random))));
  const double square = mean_of(values, [](double x) { return (x - 10) * (x - 10); });
  const RegionModel model = fit(IntensityLaw::rayleigh, values, {.location = 10.0});
  EXPECT_NEAR(model.scale / std::sqrt(.5 * square), 1, 1e-3);
  EXPECT_EQ(model.location, 10);
  EXPECT_NEAR(fit(IntensityLaw::rayleigh, values).scale / 3, 1, .02);  // from the lower end of the image
}

TEST(RegionModel, OfGammaSamplesSolvesTheirLikelihoodEquation) {
  for (const double shape : {.6, 1.0, 3.0, 50.0}) {
    std::mt19937_64 random(6);
    std::gamma_distribution<float> gamma(static_cast<float>(shape), 2);
    std::vector<float> values(many);
    for (float& value : values) value = std::max(1e-20f, gamma(random));
    const double mean = mean_of(values, [](double x) { return x; });
    const double mean_log = mean_of(values, [](double x) { return std::log(x); });
    const double k = root([&](double s) { return std::log(mean) - mean_log - std::log(s) + digamma(s); }, .05, 1e4);
    // Zero is where the first of the bins begins: the lowest sample is far nearer than a bin.
    IntensityBins bins = choose_bins(values);
    if (shape < 2) bins.lo = 0;
    const RegionModel model = fit_region_model(IntensityLaw::gamma, histogram_of(values, bins), {.location = 0.0});
    EXPECT_NEAR(model.shape / k, 1, .01) << shape;
    EXPECT_NEAR(model.shape * model.scale / mean, 1, .003) << shape;
  }
}

TEST(RegionModel, OfChanAndVeseIsTheMean) {
  const Histogram histogram = random_histogram(9);
  const RegionModel model = fit_region_model(IntensityLaw::chan_vese, histogram);
  EXPECT_EQ(model.location, histogram.mean());
  const std::vector<float> table = energy_table(model, histogram.bins);
  for (Index k = 0; k < 256; ++k)
    EXPECT_FLOAT_EQ(table[k], static_cast<float>(std::pow(histogram.bins.center(k) - model.location, 2)));
}

TEST(RegionModel, IsLikelierThanItsNeighbours) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Histogram histogram = random_histogram(seed);
    for (const IntensityLaw law : likelihood_laws) {
      const RegionModel model = fit_region_model(law, histogram);
      const double energy = energy_of(model, histogram);
      const double slack = 1e-6 * histogram.total();  // nats per voxel: where the search stops
      const bool centred = law == IntensityLaw::gaussian || law == IntensityLaw::generalized_gaussian;
      for (const double factor : {.98, 1.02}) {
        RegionModel other = model;
        other.scale *= factor;
        EXPECT_LT(energy, energy_of(other, histogram) + slack) << static_cast<int>(law) << " " << seed;
        other = model;
        other.shape = std::min(20.0, std::max(.2, model.shape * factor));
        EXPECT_LT(energy, energy_of(other, histogram) + slack) << static_cast<int>(law) << " " << seed;
        other = model;
        if (centred) other.location += (factor - 1) * model.scale;
        EXPECT_LT(energy, energy_of(other, histogram) + slack) << static_cast<int>(law) << " " << seed;
      }
    }
  }
}

TEST(RegionModel, IsNeverLessLikelyThanItsStart) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Histogram before = random_histogram(seed);
    const Histogram after = random_histogram(seed + 100);
    for (const IntensityLaw law : likelihood_laws) {
      const RegionModel start = fit_region_model(law, before);
      const RegionModel model = fit_region_model(law, after, {.start = start});
      const double rounding = 1e-6 * after.total();  // tables are of single precision
      EXPECT_LE(energy_of(model, after), energy_of(start, after) + rounding) << static_cast<int>(law);
      EXPECT_LE(energy_of(model, after), energy_of(fit_region_model(law, after), after) + .01 * after.total());
    }
  }
}

TEST(RegionModel, MovesAndScalesWithTheIntensities) {
  constexpr double precision = 1e-6;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Histogram histogram = random_histogram(seed);
    Histogram moved = histogram;
    moved.bins.lo = 1e4 * histogram.bins.lo - 300;
    moved.bins.hi = 1e4 * histogram.bins.hi - 300;
    for (const IntensityLaw law : likelihood_laws) {
      const RegionModel model = fit_region_model(law, histogram);
      const RegionModel other = fit_region_model(law, moved);
      EXPECT_NEAR(other.location, 1e4 * model.location - 300, 1e4 * precision) << static_cast<int>(law);
      EXPECT_NEAR(other.scale / (1e4 * model.scale), 1, precision) << static_cast<int>(law);
      EXPECT_NEAR(other.shape / model.shape, 1, precision) << static_cast<int>(law);
      const std::vector<float> table = energy_table(model, histogram.bins);
      const std::vector<float> same = energy_table(other, moved.bins);
      for (std::size_t k = 0; k < table.size(); ++k) EXPECT_NEAR(table[k], same[k], 1e-4) << static_cast<int>(law);
    }
  }
}

TEST(RegionModel, OfTheNegativeIsItsMirrorImage) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Histogram histogram = random_histogram(seed);
    Histogram mirrored(IntensityBins{-histogram.bins.hi, -histogram.bins.lo, 256});
    std::reverse_copy(histogram.counts.begin(), histogram.counts.end(), mirrored.counts.begin());
    for (const IntensityLaw law : {IntensityLaw::gaussian, IntensityLaw::generalized_gaussian}) {
      const RegionModel model = fit_region_model(law, histogram);
      const RegionModel other = fit_region_model(law, mirrored);
      EXPECT_NEAR(other.location, -model.location, 1e-4);
      EXPECT_NEAR(other.scale, model.scale, 1e-4);
      EXPECT_NEAR(other.shape, model.shape, 1e-3);
    }
  }
}

TEST(RegionModel, OfAConstantRegionIsFinite) {
  Histogram histogram(IntensityBins{0, 255, 255});
  for (const double value : {0.5, 100.5, 254.5}) {
    histogram.counts.assign(255, 0);
    histogram.add(value, 1000);
    for (const IntensityLaw law : likelihood_laws) {
      const RegionModel model = fit_region_model(law, histogram);
      EXPECT_TRUE(std::isfinite(model.location) && model.scale > 0 && std::isfinite(model.scale) && model.shape > 0);
      const std::vector<float> table = energy_table(model, histogram.bins);
      for (const float energy : table) {
        EXPECT_LE(energy, 14);
        EXPECT_GE(energy, -std::log(255.0) - 1e-4);
      }
      if (law == IntensityLaw::rayleigh) continue;  // one parameter cannot make it narrow
      const auto least = std::min_element(table.begin(), table.end());
      EXPECT_NEAR(static_cast<double>(least - table.begin()), value - .5, 1) << static_cast<int>(law);
    }
  }
}

TEST(RegionModel, OfAnEmptyRegionIsItsStartOrSpreadsOverTheRange) {
  const Histogram empty(IntensityBins{10, 20, 64});
  EXPECT_EQ(fit_region_model(IntensityLaw::chan_vese, empty).location, 15);
  for (const IntensityLaw law : likelihood_laws) {
    const RegionModel start{law, 12, 3, 1.5};
    const RegionModel kept = fit_region_model(law, empty, {.start = start});
    EXPECT_EQ(kept.scale, start.scale);
    EXPECT_EQ(kept.shape, start.shape);
    for (const float energy : energy_table(fit_region_model(law, empty), empty.bins)) EXPECT_LT(std::abs(energy), 4);
  }
}

}  // namespace
}  // namespace csrbf::region_model_test
