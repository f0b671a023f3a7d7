#include "csrbf/implicit/combine/extend_distance.hpp"

#include "core/error_testing.hpp"
#include "implicit/analytic_fields.hpp"

#include <gtest/gtest.h>

namespace csrbf::extend_distance_test {
namespace {

constexpr double feature_size = 0.03;
constexpr double range = 0.4;
const Point<3> center(0.2, -0.1, 0.3);

std::shared_ptr<const AnalyticField> saturated() {
  return std::make_shared<const AnalyticField>(saturated_ball(1, center, feature_size));
}

Points<3> probes(double inner, double outer, Index n) {
  Points<3> x = random_directions(n, 1);
  for (Index i = 0; i < n; ++i)
    x.col(i) = center + (inner + (outer - inner) * static_cast<double>(i) / static_cast<double>(n)) * x.col(i);
  return x;
}

TEST(ExtendDistance, KeepsTheFieldNearItsSurface) {
  const auto field = saturated();
  const auto extended = extend_distance(field, range);
  const Points<3> x = probes(1 - 0.9 * feature_size, 1 + 0.9 * feature_size, 500);
  const Jet<3> expected = field->evaluate(x, Derivatives::hessian), found = extended->evaluate(x, Derivatives::hessian);
  EXPECT_EQ(found.value, expected.value);
  EXPECT_EQ(found.gradient, expected.gradient);
  EXPECT_EQ(found.hessian, expected.hessian);
  EXPECT_EQ(extended->bounds().lo, field->bounds().lo);
  EXPECT_EQ(extended->seeds(), field->seeds());
  EXPECT_EQ(extended->feature_size(), feature_size);
}

TEST(ExtendDistance, GrowsLikeTheDistanceUpToTheRange) {
  const auto extended = extend_distance(saturated(), range);
  const Points<3> x = probes(0.6, 1.4, 2000);
  const Eigen::VectorXd found = extended->evaluate(x).value;
  // The spline is blurred over nodes range / 4 apart; where |f| turns into the distance it lacks up to its slope there.
  for (Index i = 0; i < x.cols(); ++i) EXPECT_NEAR(found[i], 1 - (x.col(i) - center).norm(), 0.05 * range);
}

TEST(ExtendDistance, KeepsTheSignEverywhere) {
  const auto field = saturated();
  const auto extended = extend_distance(field, range);
  const Points<3> x = random_points_in(box_around(center, Point<3>::Constant(4)), 3000, 2);
  const Eigen::VectorXd before = field->evaluate(x).value, after = extended->evaluate(x).value;
  for (Index i = 0; i < x.cols(); ++i) {
    EXPECT_GE(std::abs(after[i]), std::abs(before[i]));
    EXPECT_GT(after[i] * before[i], 0);
    if ((x.col(i) - center).norm() <= 1 + range) continue;
    EXPECT_LT(after[i], -0.95 * range);
  }
}

TEST(ExtendDistance, HasTrueDerivatives) {
  const auto extended = extend_distance(saturated(), range);
  const DerivativeErrors errors = derivative_errors(*extended, probes(0.5, 1.6, 500), 1e-5);
  EXPECT_LE(errors.gradient, 1e-6);
  EXPECT_LE(errors.hessian, 1e-4);
}

TEST(ExtendDistance, NeedsARangeAndAFieldThatKnowsItsDetail) {
  const auto message = [](const std::shared_ptr<const Field<3>>& field, double reach) {
    return invalid_input_message([&] { extend_distance(field, reach); });
  };
  EXPECT_NE(message(saturated(), 0).find("range = 0"), std::string::npos);
  EXPECT_NE(message(saturated(), NAN).find("range = nan"), std::string::npos);
  EXPECT_NE(message(nullptr, 1).find("field = null"), std::string::npos);
  EXPECT_NE(message(std::make_shared<const AnalyticField>(ball(1)), 1).find("feature_size of the field = 0"),
            std::string::npos);
  EXPECT_THROW(extend_distance(saturated(), range, [](std::string_view stage, double) { return stage != "extend"; }),
               Cancelled);
}

}  // namespace
}  // namespace csrbf::extend_distance_test
