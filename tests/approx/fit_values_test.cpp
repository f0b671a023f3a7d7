#include "csrbf/approx/fit_values.hpp"

#include "approx/approx_testing.hpp"
#include "csrbf/approx/fit.hpp"

namespace csrbf::fit_values_test {
namespace {

// A smooth value beside one with steps.
Samples<2> smooth_and_steps(Index n) {
  Samples<2> data = sample<2>(random_points<2>(n, 1), franke);
  data.values.conservativeResize(n, 2);
  for (Index i = 0; i < n; ++i) data.values(i, 1) = std::floor(3 * data.points(0, i));
  return data;
}

TEST(FitValues, AreAsGoodAsEachAlone) {
  const Samples<2> both = smooth_and_steps(600);
  Samples<2> smooth = both;
  smooth.values.conservativeResize(Eigen::NoChange, 1);
  const Fit<2> together = fit<2>(both), alone = fit<2>(smooth);
  ASSERT_EQ(together.components.size(), 2U);
  EXPECT_EQ(together.report.value_kernels.size(), 2U);
  const Points<2> x = random_points<2>(300, 2);
  EXPECT_EQ(together.components[0]->evaluate(x).value, alone.components[0]->evaluate(x).value);
  EXPECT_GE(together.report.max_error, largest_error<2>(*together.components[0], both));
}

TEST(FitValues, ThatAreAlikeShareTheirChoices) {
  Samples<2> data = sample<2>(random_points<2>(600, 1), franke);
  data.values.conservativeResize(Eigen::NoChange, 2);
  data.values.col(1) = 2 * data.values.col(0);
  EXPECT_TRUE(fit<2>(data).report.value_kernels.empty());
}

TEST(FitValues, ThatAreConstantSayNothingOfOthers) {
  for (const double noise : {0.0, 0.1}) {
    Samples<2> one = sample<2>(random_points<2>(900, 1), franke);
    for (Index i = 0; i < 900; ++i) one.values(i, 0) += noise * std::sin(1e4 * static_cast<double>(i));
    Samples<2> three = one;
    three.values.resize(900, 3);
    three.values << Eigen::VectorXd::Constant(900, 7), one.values, Eigen::VectorXd::Constant(900, -1e-3);
    three.values(5, 0) = std::nextafter(7, 8);  // a constant but for rounding
    const Fit<2> alone = fit<2>(one), beside = fit<2>(three);
    const Points<2> x = random_points<2>(300, 2);
    EXPECT_EQ(beside.components[1]->evaluate(x).value, alone.components[0]->evaluate(x).value);
    EXPECT_EQ(beside.variances[1]->evaluate(x).value, alone.variances[0]->evaluate(x).value);
    EXPECT_EQ(beside.report.cross_validation_rmse, alone.report.cross_validation_rmse);
    EXPECT_EQ(beside.report.rmse, alone.report.rmse);
    EXPECT_EQ(beside.components[2]->evaluate(x).value, Eigen::VectorXd::Constant(300, -1e-3));
    EXPECT_EQ(beside.variances[0]->evaluate(x).value, Eigen::VectorXd::Zero(300));
  }
}

}  // namespace
}  // namespace csrbf::fit_values_test
