#include "csrbf/approx/function.hpp"

#include "approx/approx_testing.hpp"

namespace csrbf::function_test {
namespace {

// sum of (a + 1) x_a and, in a second column, 5.
Eigen::MatrixXd planes(const Eigen::MatrixXd& points) {
  Eigen::MatrixXd values(points.cols(), 2);
  values.col(0) = points.transpose() * Eigen::VectorXd::LinSpaced(points.rows(), 1, static_cast<double>(points.rows()));
  values.col(1).setConstant(5);
  return values;
}

Eigen::MatrixXd points_in(Index dimension, Index count) {
  return random_points<1>(dimension * count, 1).reshaped(dimension, count);
}

Function planes_in(Index dimension) {
  const Eigen::MatrixXd points = points_in(dimension, 120);
  return fit_function(points, planes(points), Eigen::VectorXd(), {.method = "interpolate", .degree = 1});
}

TEST(Function, HasTheDimensionOfItsPoints) {
  constexpr double solved = 1e-5;  // systems of condition up to about 1e10
  for (Index d = 1; d <= 6; ++d) {
    const Function f = planes_in(d);
    EXPECT_EQ(f.dimension(), d);
    EXPECT_EQ(f.components(), 2);
    EXPECT_EQ(f.report().method, "interpolate");
    if (d == 3) {
      EXPECT_EQ(f.fit<3>().components.size(), 2U);
      EXPECT_THROW((void)f.fit<2>(), InvalidInput);
    }
    const Eigen::MatrixXd x = points_in(d, 40);
    const Function::Values values = f.evaluate(x, Derivatives::hessian);
    ASSERT_EQ(values.value.rows(), 40);
    ASSERT_EQ(values.value.cols(), 2);
    ASSERT_EQ(values.gradient.cols(), 2 * d);
    ASSERT_EQ(values.hessian.cols(), d * (d + 1));
    EXPECT_LE((values.value - planes(x)).cwiseAbs().maxCoeff(), solved);
    for (Index a = 0; a < d; ++a) {
      EXPECT_LE((values.gradient.col(a).array() - static_cast<double>(a + 1)).abs().maxCoeff(), 10 * solved) << d;
      EXPECT_LE(values.gradient.col(d + a).cwiseAbs().maxCoeff(), 10 * solved) << d;
    }
    EXPECT_LE(values.hessian.cwiseAbs().maxCoeff(), 100 * solved) << d;
  }
}

TEST(Function, ReturnsOnlyTheDerivativesAskedFor) {
  const Function f = planes_in(3);
  const Eigen::MatrixXd x = points_in(3, 10);
  EXPECT_EQ(f.evaluate(x).gradient.cols(), 0);
  EXPECT_EQ(f.evaluate(x, Derivatives::gradient).gradient.cols(), 6);
  EXPECT_EQ(f.evaluate(x, Derivatives::gradient).hessian.cols(), 0);
  EXPECT_EQ(f.evaluate(Eigen::MatrixXd(3, 0)).value.rows(), 0);
}

TEST(Function, IsItsFit) {
  const Samples<2> data = sample<2>(random_points<2>(200, 1), franke);
  const Function f = fit_function(data.points, data.values, data.weights);
  const Fit<2> same = fit<2>(data);
  const Points<2> x = random_points<2>(50, 2);
  const Function::Values values = f.evaluate(x, Derivatives::gradient);
  const Jet<2> jet = same.components[0]->evaluate(x, Derivatives::gradient);
  EXPECT_EQ(values.value.col(0), jet.value);
  EXPECT_EQ(values.gradient, jet.gradient.transpose());
}

TEST(Function, EvaluatesColumnsOfALargerMatrix) {
  const Function f = planes_in(2);
  const Eigen::MatrixXd wide = points_in(5, 30);
  const Eigen::MatrixXd narrow = wide.middleRows(1, 2);
  EXPECT_EQ(f.evaluate(wide.middleRows(1, 2)).value, f.evaluate(narrow).value);
}

TEST(Function, KnowsTheBoxOfItsSamples) {
  const Function f = planes_in(3);
  const Eigen::MatrixXd points = points_in(3, 120);
  ASSERT_EQ(f.bounds().cols(), 2);
  EXPECT_EQ(f.bounds().col(0), points.rowwise().minCoeff());
  EXPECT_EQ(f.bounds().col(1), points.rowwise().maxCoeff());
}

TEST(Function, RefusesOtherDimensions) {
  for (const Index d : {0, 21}) {
    const Eigen::MatrixXd points(d, 10);
    expect_refusal([&] { fit_function(points, Eigen::MatrixXd::Zero(10, 1), Eigen::VectorXd()); },
                   "fit: dimension = " + std::to_string(d) + ": must be 1 to 20");
  }
  expect_refusal([] { (void)planes_in(3).evaluate(points_in(2, 10)); },
                 "evaluate: dimension of the points = 2: must be 3, that of the function");
}

TEST(Function, RefusesFitsWithoutAField) {
  expect_refusal([] { Function{Fit<2>{}}; }, "Function: components of the fit = 0: there must be at least one");
  expect_refusal([] { Function{Fit<2>{.components = {nullptr}}}; },
                 "Function: component of the fit = null: must point to a field");
}

}  // namespace
}  // namespace csrbf::function_test
