#include "thesis/table_2_4.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace csrbf::thesis::table_2_4_test {
namespace {

// Times depend on the machine, numbers of entries do not.
TEST(Table_2_4, RowsOfTheSparseMatrixDoNotGrowWithTheNumberOfSamples) {
  const Costs few = compact_costs(1000);
  const Costs many = compact_costs(16000);
  const double in_support = 9 * std::numbers::pi;  // density n, radius 3 / sqrt n
  EXPECT_NEAR(few.nonzeros, in_support, 0.2 * in_support);
  EXPECT_NEAR(many.nonzeros, in_support, 0.05 * in_support);
}

TEST(Table_2_4, TheFactorGrowsMuchSlowerThanThatOfADenseMatrix) {
  const Costs few = compact_costs(1000);
  const Costs many = compact_costs(16000);
  // In the plane fill-in of nested orderings grows as log N; the factor of a dense matrix would be 16 times longer.
  EXPECT_LT(many.factor, 4 * few.factor);
  EXPECT_LT(many.factor, 0.02 * many.samples);
}

// 16 times the samples: O(1) to O(log N) against O(N). The factor 4 leaves room for other work of the machine.
TEST(Table_2_4, EvaluationAtOnePointBarelyDependsOnTheNumberOfSamples) {
  EXPECT_LT(compact_costs(16000).evaluation, 4 * compact_costs(1000).evaluation);
}

// By fast sums as well; ten times the samples.
TEST(Table_2_4, FastSumsMakeTheCostOfGlobalSupportsGrowAboutAsTheNumberOfSamples) {
  const Costs few = fast_costs(3000), many = fast_costs(30000);
  EXPECT_LT(many.solve, 40 * few.solve);
  EXPECT_LT(many.evaluation, 4 * few.evaluation);
}

}  // namespace
}  // namespace csrbf::thesis::table_2_4_test
