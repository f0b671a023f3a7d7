#include "csrbf/approx/kriging/confirm_errors.hpp"

#include "approx/approx_testing.hpp"

namespace csrbf::confirm_errors_test {
namespace {

RobustWeights confirmed(const Samples<2>& samples, const std::vector<Index>& suspects) {
  RobustWeights weights;
  weights.suspects = suspects;
  confirm_errors(samples, weights);
  return weights;
}

TEST(ConfirmErrors, LeavesOutWhatTheOthersDoNotExpectAndKeepsWhatTheyDo) {
  for (const double wrong : {1.5, 30.0}) {
    Samples<2> data = sample<2>(random_points<2>(60, 5), franke);
    data.values(17) += wrong;
    const RobustWeights found = confirmed(data, {3, 17});
    EXPECT_EQ(found.gross_errors, std::vector<Index>{17}) << wrong;
    EXPECT_EQ(found.suspects, std::vector<Index>{3});
    EXPECT_EQ(found.factors[17], 0);
    EXPECT_EQ(found.factors.sum(), 59);
  }
}

TEST(ConfirmErrors, KeepsTheEndOfAnExponential) {
  const Points<1> x = Eigen::RowVectorXd::LinSpaced(12, 0, 1);
  const Samples<1> data = sample<1>(x, [](const Point<1>& p) { return std::exp(6 * p[0]); });
  RobustWeights found = robust_weights(data, "auto");
  ASSERT_EQ(found.suspects.back(), 11);
  confirm_errors(data, found);
  EXPECT_EQ(found.suspects.back(), 11);
}

TEST(ConfirmErrors, TakesRepeatedPointsAndTooFew) {
  Samples<2> data = sample<2>(random_points<2>(40, 5), franke);
  data.points.col(8) = data.points.col(9);
  data.values(20) = 9;
  EXPECT_EQ(confirmed(data, {20}).gross_errors, std::vector<Index>{20});
  const Samples<2> few = sample<2>(random_points<2>(4, 5), franke);
  EXPECT_EQ(confirmed(few, {2}).suspects, std::vector<Index>{2});
  EXPECT_EQ(confirmed(few, {2}).factors.size(), 0);
}

}  // namespace
}  // namespace csrbf::confirm_errors_test
