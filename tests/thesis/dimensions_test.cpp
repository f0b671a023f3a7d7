#include "thesis/dimensions.hpp"

#include <gtest/gtest.h>

namespace csrbf::thesis {
namespace {

template <int Dim>
void expect_much_better_than_the_nearest_sample(double factor) {
  const double nearest = fit_dimension<Dim>("nearest", 400).rmse;
  EXPECT_LT(factor * fit_dimension<Dim>("auto", 400).rmse, nearest) << "d = " << Dim;
}

TEST(Dimensions, TheDefaultFitIsMuchBetterThanTheNearestSample) {
  expect_much_better_than_the_nearest_sample<3>(100);
  expect_much_better_than_the_nearest_sample<4>(100);
  expect_much_better_than_the_nearest_sample<5>(20);
  expect_much_better_than_the_nearest_sample<6>(10);
}

TEST(Dimensions, EveryMethodLearnsFromMoreSamplesInThreeDimensions) {
  for (const char* method : {"partition-of-unity", "multilevel", "fixed-budget"})
    EXPECT_LT(fit_dimension<3>(method, 4000).rmse, fit_dimension<3>(method, 500).rmse) << method;
}

}  // namespace
}  // namespace csrbf::thesis
