#include "thesis/figure_3_14.hpp"

#include <gtest/gtest.h>

namespace csrbf::thesis {
namespace {

TEST(Figure_3_14, TheSliceHasThePublishedNumberOfPixelsAndSamples) {
  const auto slice = brain_slice();
  if (!slice) GTEST_SKIP() << brain_file << " is not there: apt-get install mricron-data";
  EXPECT_EQ(slice->values.size(), 39060);
  EXPECT_EQ(sample_slice(*slice, 0.3, 1).samples.size(), 11718);
}

TEST(Figure_3_14, SamplesAreDistinctPixelsWithTheirValues) {
  const SampledSlice sampled = sample_slice(drawn_slice(40, 30), 0.3, 1);
  ASSERT_EQ(sampled.samples.size(), 360);
  for (Index i = 0; i < 360; ++i) {
    const Index id = sampled.ids[static_cast<std::size_t>(i)];
    if (i > 0) {
      EXPECT_GT(id, sampled.ids[static_cast<std::size_t>(i - 1)]);
    }
    EXPECT_EQ(sampled.samples.points(0, i), static_cast<double>(id % 40));
    EXPECT_EQ(sampled.samples.points(1, i), static_cast<double>(id / 40));
    EXPECT_EQ(sampled.samples.values(i, 0), sampled.slice.values[id]);
  }
}

void expect_errors_to_fall(const SampledSlice& sampled) {
  const auto all = budget_errors(sampled, {0.1, 0.5, 1});
  for (std::size_t i = 1; i < all.size(); ++i) {
    EXPECT_LT(all[i].errors.samples, all[i - 1].errors.samples);
    EXPECT_LT(all[i].errors.all,
              1.1 * all[i - 1].errors.all);  // between the samples a small image leaves little to gain
  }
}

TEST(Figure_3_15, BothErrorsFallWithTheBudget) {
  expect_errors_to_fall(sample_slice(drawn_slice(109, 90), 0.3, 1));
}

TEST(Figure_3_15, BothErrorsFallWithTheBudgetOnTheBrain) {
  const auto slice = brain_slice();
  if (!slice) GTEST_SKIP() << brain_file << " is not there: apt-get install mricron-data";
  expect_errors_to_fall(sample_slice(*slice, 0.3, 1));
}

}  // namespace
}  // namespace csrbf::thesis
