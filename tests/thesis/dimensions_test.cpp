#include "thesis/dimensions.hpp"

#include <gtest/gtest.h>

namespace csrbf::thesis::dimensions_test {
namespace {

template <int Dim>
void expect_much_better_than_the_nearest_sample(const char* method, Index samples, double factor) {
  const double nearest = fit_dimension<Dim>("nearest", samples).rmse;
  EXPECT_LT(factor * fit_dimension<Dim>(method, samples).rmse, nearest) << method << ", d = " << Dim;
}

TEST(Dimensions, ThePartitionOfUnityIsMuchBetterThanTheNearestSample) {
  expect_much_better_than_the_nearest_sample<3>("partition-of-unity", 2000, 100);
  expect_much_better_than_the_nearest_sample<4>("partition-of-unity", 2000, 50);
  expect_much_better_than_the_nearest_sample<5>("partition-of-unity", 2000, 20);
  expect_much_better_than_the_nearest_sample<6>("partition-of-unity", 2000, 10);
}

TEST(Dimensions, TheDefaultFitOfFewSamplesIsMuchBetterThanTheNearestSample) {
  expect_much_better_than_the_nearest_sample<4>("auto", 200, 20);
}

// The method of the thesis with a tenth of the samples as centres.
TEST(Dimensions, TheFixedBudgetIsBetterThanTheNearestSample) {
  expect_much_better_than_the_nearest_sample<3>("fixed-budget", 2000, 3);
  expect_much_better_than_the_nearest_sample<6>("fixed-budget", 2000, 2);
}

TEST(Dimensions, EveryMethodLearnsFromMoreSamplesInThreeDimensions) {
  for (const char* method : {"partition-of-unity", "multilevel", "fixed-budget"})
    EXPECT_LT(fit_dimension<3>(method, 4000).rmse, fit_dimension<3>(method, 500).rmse) << method;
}

}  // namespace
}  // namespace csrbf::thesis::dimensions_test
