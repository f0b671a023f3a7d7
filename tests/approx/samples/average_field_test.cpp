#include "csrbf/approx/samples/average_field.hpp"

#include "approx/approx_testing.hpp"
#include "csrbf/approx/fit.hpp"

namespace csrbf::average_field_test {
namespace {

std::vector<std::shared_ptr<const Field<2>>> fields_of(const std::vector<Fit<2>>& fits, bool variances) {
  std::vector<std::shared_ptr<const Field<2>>> fields;
  for (const Fit<2>& one : fits) fields.push_back(variances ? one.variances[0] : one.components[0]);
  return fields;
}

TEST(AverageField, IsTheMeanOfItsFieldsAndTheVarianceOfAllThatTheySay) {
  const Samples<2> data = sample<2>(random_points<2>(40, 1), franke);
  const std::vector<Fit<2>> fits = {fit<2>(data, {.method = "interpolate", .kernel = "matern-c2"}),
                                    fit<2>(data, {.method = "interpolate", .kernel = "gaussian"})};
  const std::vector<double> weights = {.3, .7};
  const auto means = fields_of(fits, false), variances = fields_of(fits, true);
  const AverageField<2> mean(means, weights), variance(means, weights, variances);
  const Points<2> x = .1 + .8 * random_points<2>(30, 2).array();  // in the box of the samples
  const Eigen::VectorXd one = means[0]->evaluate(x).value, other = means[1]->evaluate(x).value;
  EXPECT_TRUE(mean.evaluate(x).value.isApprox(.3 * one + .7 * other, 1e-12));
  // Of two laws with the shares a and b: their variances, and a b times the squared distance of their means.
  const Eigen::VectorXd expected =
      .3 * variances[0]->evaluate(x).value + .7 * variances[1]->evaluate(x).value + .21 * (one - other).cwiseAbs2();
  EXPECT_TRUE(variance.evaluate(x).value.isApprox(expected, 1e-9));
  EXPECT_TRUE(std::isnan(variance.evaluate(x, Derivatives::gradient).gradient(0, 0)));
  expect_true_derivatives<2>(mean, x, 1e-4, 1e-3);

  const auto errors = errors_of<2>({means[0]}, {means[1]}, {variances[1]});
  const Eigen::VectorXd missed = variances[1]->evaluate(x).value + (one - other).cwiseAbs2();
  EXPECT_TRUE(errors.at(0)->evaluate(x).value.isApprox(missed, 1e-9));
}

}  // namespace
}  // namespace csrbf::average_field_test
