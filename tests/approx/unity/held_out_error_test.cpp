#include "csrbf/approx/unity/held_out_error.hpp"

#include "csrbf/approx/unity/fit_patches.hpp"
#include "csrbf/approx/unity/partition_of_unity_field.hpp"
#include "csrbf/core/parallel.hpp"

#include "approx/approx_testing.hpp"

namespace csrbf::held_out_error_test {
namespace {

TEST(HeldOutError, IsThatOfTheNoiseWhereTheFunctionIsKnown) {
  Samples<2> data = sample<2>(random_points<2>(20000, 1), franke);
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0, .1);
  for (double& value : data.values.reshaped()) value += noise(random);
  const HeldOutError error(HeldOutSamples<2>(data).errors({.degree = 4, .samples = 700, .centers = 0}));
  EXPECT_NEAR(error.rmse, .1, .01);
  EXPECT_NEAR(error.mean, .1 * std::sqrt(2 / std::acos(-1)), .01);  // E|e| of a normal distribution
}

TEST(HeldOutError, IsSmallForSmoothFunctionsInAllDimensions) {
  const auto error = []<int Dim>(std::integral_constant<int, Dim>) {
    const Samples<Dim> data = sample<Dim>(random_points<Dim>(3000, 1), waves<Dim>);
    return HeldOutError(HeldOutSamples<Dim>(data).errors({.samples = 60, .centers = 60})).rmse;
  };
  EXPECT_LE(error(std::integral_constant<int, 1>()), 1e-6);
  EXPECT_LE(error(std::integral_constant<int, 2>()), 1e-3);
  EXPECT_LE(error(std::integral_constant<int, 3>()), 1e-2);
  EXPECT_LE(error(std::integral_constant<int, 6>()), 1);
}

TEST(HeldOutError, DoesNotDependOnUnitsAndThreads) {
  const Samples<2> data = sample<2>(random_points<2>(3000, 1), franke);
  const LocalOptions options{.degree = 1, .samples = 20, .centers = 20, .anisotropy = .8};
  const HeldOutError error(HeldOutSamples<2>(data).errors(options));
  Samples<2> other = data;
  other.points *= 0x1p100;
  other.values *= 0x1p-600;
  EXPECT_EQ(HeldOutError(HeldOutSamples<2>(other).errors(options)).mean, 0x1p-600 * error.mean);
  set_thread_count(1);
  EXPECT_EQ(HeldOutError(HeldOutSamples<2>(data).errors(options)).rmse, error.rmse);
  set_thread_count(0);
}

TEST(FitPatches, AtSomePlacesAreThoseOfTheWholeFitThere) {
  const Samples<3> data = sample<3>(random_points<3>(4000, 1), waves<3>);
  const Points<3> x = random_points<3>(20, 2);
  const LocalOptions options{.samples = 30, .centers = 30, .anisotropy = .5};
  const auto value = [&](const Points<3>* places) {
    return PartitionOfUnity<3>(fit_patches<3>(data, options, {}, places)).evaluate(x).value;
  };
  EXPECT_EQ(value(&x), value(nullptr));
}

}  // namespace
}  // namespace csrbf::held_out_error_test
