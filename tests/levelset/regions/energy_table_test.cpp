#include "csrbf/levelset/regions/energy_table.hpp"

#include "core/error_testing.hpp"
#include "csrbf/core/parallel.hpp"
#include "levelset/intensity_testing.hpp"

#include <gtest/gtest.h>

namespace csrbf::energy_table_test {
namespace {

TEST(EnergyTable, IsMinusTheLogDensityOverTheRange) {
  const IntensityBins bins{0, 8, 256};
  for (const IntensityLaw law : likelihood_laws) {
    const bool one_sided = law == IntensityLaw::rayleigh || law == IntensityLaw::gamma;
    const RegionModel model{law, one_sided ? 0.0 : 4.0, 1, 3};
    const std::vector<float> table = energy_table(model, bins);
    for (Index k = 1; k < 255; ++k) {
      const double expected = -log_density(model, bins.center(k)) - std::log(8.0);
      if (expected > 6) continue;  // there the contamination is seen, and near 0 that a bin has a width
      EXPECT_NEAR(table[k], expected, .04) << static_cast<int>(law) << " " << k;
    }
  }
}

TEST(EnergyTable, IsLinearBetweenTheBins) {
  const IntensityBins bins{-1, 3, 8};
  std::vector<float> table(8);
  for (Index k = 0; k < 8; ++k) table[k] = static_cast<float>(2 * bins.center(k) + 1);
  const std::vector<float> values = {-.75f, 0, .1f, 1.33f, 2.75f};
  std::vector<float> energies(values.size());
  look_up_energies(values, table, bins, energies);
  for (std::size_t i = 0; i < values.size(); ++i) EXPECT_FLOAT_EQ(energies[i], 2 * values[i] + 1);
  const std::vector<float> beyond = {-100, -1, 3, 1e30f};
  energies.resize(4);
  look_up_energies(beyond, table, bins, energies);
  EXPECT_EQ(energies, (std::vector<float>{table[0], table[0], table[7], table[7]}));
}

TEST(EnergyTable, OfBinsIsWhatTheTotalCounts) {
  const std::vector<float> values = uniform_samples(1001, 2, 11);
  const IntensityBins bins = choose_bins(values, 37);
  const std::vector<float> table = energy_table({IntensityLaw::gaussian, .3, .5, 2}, bins);
  std::vector<float> energies(values.size());
  look_up_energies(bin_indices(values, bins), table, energies);
  double sum = 0;
  for (const float energy : energies) sum += static_cast<double>(energy);
  EXPECT_NEAR(sum, total_energy(table, histogram_of(values, bins)), 1e-9 * std::abs(sum));
  look_up_energies(std::vector<std::uint8_t>{36, 37, 255}, table, std::span(energies).first(3));
  EXPECT_EQ(energies[0], table[36]);
  EXPECT_EQ(energies[1], 0);
  EXPECT_EQ(energies[2], 0);
}

TEST(EnergyTable, GivesTheSameEnergiesForEveryNumberOfThreads) {
  const std::vector<float> values = uniform_samples(300000, 2, 10);
  const IntensityBins bins = choose_bins(values);
  const std::vector<float> table = energy_table({IntensityLaw::gaussian, .3, .5, 2}, bins);
  const auto energies = [&](int threads) {
    set_thread_count(threads);
    std::vector<float> result(values.size());
    look_up_energies(values, table, bins, result);
    set_thread_count(0);
    return result;
  };
  EXPECT_EQ(energies(1), energies(3));
}

TEST(EnergyTable, TellsLaplaceFromUniformOfEqualMeanAndVariance) {
  constexpr std::size_t many = 200000;
  const double half_width = std::sqrt(6.0);  // variance 2, as Laplace of scale 1
  std::vector<float> values = generalized_gaussian_samples(many, 1, 1, 7);
  const std::vector<float> uniform = uniform_samples(many, half_width, 8);
  values.insert(values.end(), uniform.begin(), uniform.end());
  const IntensityBins bins = choose_bins(values);
  const std::span<const float> all = values;
  const Histogram inside = histogram_of(all.first(many), bins);
  const Histogram outside = histogram_of(all.last(many), bins);
  const RegionModel in = fit_region_model(IntensityLaw::generalized_gaussian, inside);
  const RegionModel out = fit_region_model(IntensityLaw::generalized_gaussian, outside);
  EXPECT_NEAR(in.shape, 1, .02);
  EXPECT_GT(out.shape, 15);
  // Eq. (8.32) over windows of 49 voxels.
  const std::vector<float> a = energy_table(in, bins);
  const std::vector<float> b = energy_table(out, bins);
  std::vector<float> difference(a.size());
  for (std::size_t k = 0; k < a.size(); ++k) difference[k] = a[k] - b[k];
  std::vector<float> V(values.size());
  look_up_energies(values, difference, bins, V);
  int wrong = 0;
  constexpr std::size_t window = 49;
  for (std::size_t i = 0; i + window <= many; i += window) {
    float in_sum = 0;
    float out_sum = 0;
    for (std::size_t j = i; j < i + window; ++j) {
      in_sum += V[j];
      out_sum += V[many + j];
    }
    wrong += (in_sum > 0 ? 1 : 0) + (out_sum < 0 ? 1 : 0);
  }
  EXPECT_LT(wrong, .01 * 2 * static_cast<double>(many / window));
}

TEST(EnergyTable, RejectsWhatDoesNotFit) {
  const Histogram histogram(IntensityBins{0, 1, 2});
  std::vector<float> three(3);
  EXPECT_EQ(invalid_input_message([&] {
              total_energy({1, 2, 3}, histogram);
            }),
            "total_energy: table.size() = 3: must be the number of bins");
  EXPECT_THROW(look_up_energies(three, {1, 2, 3}, histogram.bins, three), InvalidInput);
  EXPECT_THROW(look_up_energies(three, {1, 2}, histogram.bins, std::span(three).first(2)), InvalidInput);
  EXPECT_THROW(look_up_energies(std::vector<std::uint8_t>(2), {1, 2}, three), InvalidInput);
  EXPECT_THROW(look_up_energies(three, {1}, IntensityBins{0, 1, 1}, three), InvalidInput);
}

}  // namespace
}  // namespace csrbf::energy_table_test
