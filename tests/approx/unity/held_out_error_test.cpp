#include "csrbf/approx/unity/held_out_error.hpp"

#include "csrbf/approx/unity/fit_patches.hpp"
#include "csrbf/approx/unity/partition_of_unity_field.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/core/percentile.hpp"

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

// Parallel lines `apart` from each other, with samples .005 apart on them, slanting so that they share no coordinates.
Points<2> slanting_lines(double apart) {
  const auto lines = static_cast<Index>(1 / apart);
  Points<2> x(2, 200 * lines);
  for (Index i = 0; i < x.cols(); ++i) {
    const double t = static_cast<double>(i % 200) / 200;
    x.col(i) << t, apart * (static_cast<double>(i / 200) + .3 * t);
  }
  return x;
}

TEST(HeldOutInGaps, AreAsFarFromOthersAsPlacesBetweenLinesAre) {
  const double apart = .08;
  const Points<2> x = slanting_lines(apart);
  const auto rows = held_out_in_gaps<2>(x);
  ASSERT_TRUE(rows);
  std::vector<double> distances;
  for (const Index i : rows->asked) {
    double r2 = 1;
    for (const Index j : rows->others) r2 = std::min(r2, (x.col(i) - x.col(j)).squaredNorm());
    distances.push_back(std::sqrt(r2));
  }
  EXPECT_NEAR(median(distances), apart / 4, .4 * apart / 4);
  EXPECT_LE(*std::max_element(distances.begin(), distances.end()), .6 * apart);
  EXPECT_GE(std::ssize(rows->others), x.cols() * 4 / 5);
}

TEST(HeldOutInGaps, AreNoneOfEvenSamples) {
  EXPECT_FALSE(held_out_in_gaps<2>(random_points<2>(3000, 1)));
  EXPECT_FALSE(held_out_in_gaps<2>(random_points<2>(300, 2)));
  EXPECT_FALSE(held_out_in_gaps<3>(random_points<3>(3000, 1)));
  EXPECT_FALSE(held_out_in_gaps<2>(unit_grid(50)));
  EXPECT_FALSE(held_out_in_gaps<1>(random_points<1>(1000, 1)));
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
