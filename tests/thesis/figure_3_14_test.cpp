#include "thesis/figure_3_14.hpp"

#include <gtest/gtest.h>

namespace csrbf::thesis::figure_3_14_test {
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
    const Index id = sampled.ids[i];
    if (i > 0) {
      EXPECT_GT(id, sampled.ids[i - 1]);
    }
    EXPECT_EQ(sampled.samples.points(0, i), static_cast<double>(id % 40));
    EXPECT_EQ(sampled.samples.points(1, i), static_cast<double>(id / 40));
    EXPECT_EQ(sampled.samples.values(i, 0), sampled.slice.values[id]);
  }
}

TEST(Figure_3_15, BothErrorsFallWithTheBudget) {
  const auto all = budget_errors(sample_slice(drawn_slice(109, 90), 0.3, 1), {0.1, 0.5, 1});
  EXPECT_LT(all[1].errors.samples, all[0].errors.samples);
  EXPECT_LT(all[2].errors.samples, all[1].errors.samples);
  // Over all pixels only at first: of a drawing with sharp edges the samples do not know more.
  EXPECT_LT(all[1].errors.all, all[0].errors.all);
  EXPECT_LT(all[2].errors.all, 1.1 * all[1].errors.all);
}

TEST(Figure_3_15, BothErrorsFallWithTheBudgetOnTheBrain) {
  const auto slice = brain_slice();
  if (!slice) GTEST_SKIP() << brain_file << " is not there: apt-get install mricron-data";
  const auto all = budget_errors(sample_slice(*slice, 0.3, 1), {0.1, 0.5, 1});
  for (std::size_t i = 1; i < all.size(); ++i) {
    EXPECT_LT(all[i].errors.samples, all[i - 1].errors.samples);
    EXPECT_LT(all[i].errors.all, all[i - 1].errors.all);
  }
}

}  // namespace
}  // namespace csrbf::thesis::figure_3_14_test
