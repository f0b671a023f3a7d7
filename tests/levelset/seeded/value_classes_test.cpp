#include "csrbf/levelset/seeded/value_classes.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace csrbf::value_classes_test {
namespace {

std::vector<double> histogram_of(const std::vector<double>& means) {
  std::vector<double> histogram(128, 0);
  for (const double mean : means)
    for (std::size_t i = 0; i < histogram.size(); ++i)
      histogram[i] += 1000 * std::exp(-0.5 * std::pow((static_cast<double>(i) - mean) / 4, 2));
  return histogram;
}

TEST(ValueClasses, EndBetweenThePeaks) {
  const std::vector<std::size_t> starts = value_classes(histogram_of({20, 60, 90}), 1);
  ASSERT_EQ(starts.size(), 4);
  EXPECT_EQ(starts.front(), 0);
  EXPECT_NEAR(static_cast<double>(starts[1]), 40, 3);
  EXPECT_NEAR(static_cast<double>(starts[2]), 75, 2);
  EXPECT_EQ(starts.back(), 128);
}

TEST(ValueClasses, AreNoMoreThanTheSamplesShow) {
  EXPECT_EQ(value_classes(histogram_of({60}), 1e-2).size(), 2);
  EXPECT_EQ(value_classes(histogram_of({20, 60, 90}), 1e-5).size(), 2) << "hardly any sample is independent";
}

}  // namespace
}  // namespace csrbf::value_classes_test
