#include "csrbf/approx/samples/merge_duplicates.hpp"

#include "approx/approx_testing.hpp"

namespace csrbf::merge_duplicates_test {
namespace {

Samples<1> three_at_one_point() {
  Samples<1> samples{Points<1>(1, 5), Eigen::MatrixXd(5, 1), {}};
  samples.points << 2, -0.0, 2, 0, 2;
  samples.values << 1, 10, 2, 20, 6;
  return samples;
}

TEST(MergeDuplicates, TakesTheMeanOfValuesAtOnePoint) {
  const auto merged = merge_duplicates(three_at_one_point());
  ASSERT_EQ(merged.samples.size(), 2);
  EXPECT_EQ(merged.samples.points(0), 2);
  EXPECT_DOUBLE_EQ(merged.samples.values(0), 3);
  EXPECT_DOUBLE_EQ(merged.samples.values(1), 15);
  EXPECT_EQ(merged.samples.weights, Eigen::Vector2d(3, 2));
  EXPECT_EQ(merged.spread, Eigen::Vector2d(2.5, 5));
  EXPECT_EQ(merged.place, (std::vector<Index>{0, 1, 0, 1, 0}));
  EXPECT_EQ(merged.merged(), 3);
}

TEST(MergeDuplicates, WeighsTheMean) {
  Samples<1> samples = three_at_one_point();
  samples.weights = (Eigen::VectorXd(5) << 1, 0, 3, 0, 0).finished();
  const auto merged = merge_duplicates(samples);
  EXPECT_DOUBLE_EQ(merged.samples.values(0), 1.75);
  EXPECT_DOUBLE_EQ(merged.samples.values(1), 15);  // no weights: the plain mean
  EXPECT_EQ(merged.samples.weights, Eigen::Vector2d(4, 0));
}

TEST(MergeDuplicates, TakesTheMiddleOfTheRangeWhenAsked) {
  const auto merged = merge_duplicates(three_at_one_point(), DuplicateValue::midrange);
  EXPECT_EQ(merged.samples.values(0), 3.5);
  EXPECT_EQ(merged.samples.values(1), 15);
}

// They say nothing that one of them does not.
TEST(MergeDuplicates, CountsCopiesOnce) {
  Samples<1> samples = three_at_one_point();
  samples.values << 3, 15, 3, 15, 3;
  EXPECT_EQ(merge_duplicates(samples).samples.weights, Eigen::Vector2d(1, 1));
  samples.weights = (Eigen::VectorXd(5) << 1, 0, 3, 2, 3).finished();
  EXPECT_EQ(merge_duplicates(samples).samples.weights, Eigen::Vector2d(3, 2));
  samples.values(0) += 1e-6;  // rounded
  EXPECT_EQ(merge_duplicates(samples).samples.weights, Eigen::Vector2d(3, 2));
  EXPECT_EQ(merge_duplicates(samples).replicates.count, 0);
  samples.values(0) += 1e-2;
  EXPECT_EQ(merge_duplicates(samples).samples.weights, Eigen::Vector2d(7, 2));
  EXPECT_GT(merge_duplicates(samples).replicates.count, 0);
}

TEST(MergeDuplicates, LeavesDistinctSamplesAlone) {
  const Samples<3> samples = sample<3>(random_points<3>(100, 1), waves<3>);
  const auto merged = merge_duplicates(samples);
  EXPECT_EQ(merged.samples.points, samples.points);
  EXPECT_EQ(merged.samples.values, samples.values);
  EXPECT_EQ(merged.samples.weights.size(), 0);
  EXPECT_EQ(merged.merged(), 0);
}

}  // namespace
}  // namespace csrbf::merge_duplicates_test
