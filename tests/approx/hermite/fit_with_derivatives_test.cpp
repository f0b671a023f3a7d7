#include "csrbf/approx/hermite/fit_with_derivatives.hpp"

#include "approx/approx_testing.hpp"
#include "csrbf/approx/fit.hpp"

namespace csrbf::fit_with_derivatives_test {
namespace {

// waves() and its gradients.
template <int Dim>
Eigen::MatrixXd gradients_of_waves(const Points<Dim>& x) {
  Eigen::MatrixXd g(x.cols(), Dim);
  for (Index i = 0; i < x.cols(); ++i)
    for (int a = 0; a < Dim; ++a) g(i, a) = (2 + a) * std::cos((2 + a) * x(a, i) + a);
  return g;
}

// Away from the border of the box of the samples.
template <int Dim>
double inner_error(const Field<Dim>& field) {
  const Points<Dim> x = (.1 + .8 * random_points<Dim>(1000, 99).array()).matrix();
  return largest_error<Dim>(field, sample<Dim>(x, waves<Dim>));
}

TEST(FitWithDerivatives, PredictsBetterThanValuesAlone) {
  const Points<2> x = random_points<2>(80, 1);
  const Samples<2> data = sample<2>(x, waves<2>);
  const Fit<2> plain = fit<2>(data), hermite = fit<2>(data, {.gradients = gradients_of_waves<2>(x)});
  EXPECT_LE(inner_error<2>(*hermite.components[0]), 1e-5);
  EXPECT_LE(inner_error<2>(*hermite.components[0]), .3 * inner_error<2>(*plain.components[0]));
  EXPECT_LE(hermite.report.max_error, 1e-6);
}

TEST(FitWithDerivatives, MeetsTheDerivatives) {
  const Points<2> x = random_points<2>(80, 1);
  const Eigen::MatrixXd g = gradients_of_waves<2>(x);
  const auto f = fit<2>(sample<2>(x, waves<2>), {.gradients = g}).components[0];
  const Jet<2> jet = f->evaluate(x, Derivatives::gradient);
  EXPECT_LE((jet.gradient.transpose() - g).cwiseAbs().maxCoeff(), 1e-5);
  expect_true_derivatives<2>(*f, random_points<2>(20, 5), 1e-4, 1e-4);
}

TEST(FitWithDerivatives, FitsManySamplesInPatches) {
  const Points<2> x = random_points<2>(2000, 1);
  const Fit<2> result = fit<2>(sample<2>(x, waves<2>), {.gradients = gradients_of_waves<2>(x)});
  EXPECT_EQ(result.report.method, "partition-of-unity");
  EXPECT_LE(inner_error<2>(*result.components[0]), 1e-6);
  expect_true_derivatives<2>(*result.components[0], (.1 + .8 * random_points<2>(20, 5).array()).matrix(), 1e-4, 1e-4);
  ASSERT_EQ(result.variances.size(), 1U);
}

TEST(FitWithDerivatives, LeavesOutDerivativesThatAreUnknown) {
  const Points<1> x = random_points<1>(12, 1);
  Eigen::MatrixXd g = gradients_of_waves<1>(x);
  for (Index i = 0; i < 12; i += 2) g(i, 0) = std::nan("");
  EXPECT_LE(rms_error<1>(*fit<1>(sample<1>(x, waves<1>), {.gradients = g}).components[0], waves<1>), 1e-2);
  g.setConstant(std::nan(""));
  EXPECT_LE(rms_error<1>(*fit<1>(sample<1>(x, waves<1>), {.gradients = g}).components[0], waves<1>), .2);
}

TEST(FitWithDerivatives, SmoothsNoise) {
  const Points<2> x = random_points<2>(300, 1);
  Samples<2> data = sample<2>(x, waves<2>);
  Eigen::MatrixXd g = gradients_of_waves<2>(x);
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (double& value : data.values.reshaped()) value += .1 * normal(random);
  for (double& value : g.reshaped()) value += .3 * normal(random);
  const Fit<2> result = fit<2>(data, {.gradients = g});
  EXPECT_LE(rms_error<2>(*result.components[0], waves<2>), .04);
  EXPECT_NEAR(result.report.noise[0], .1, .02);
  EXPECT_NEAR(std::sqrt((*result.variances[0])(Point<2>(.5, .5))), .1, .03);
}

TEST(FitWithDerivatives, KeepsItsUnits) {
  const Points<2> x = random_points<2>(60, 1);
  Samples<2> data = sample<2>(x, waves<2>);
  data.points *= 1e-200;
  data.values *= 1e50;
  const auto f = fit<2>(data, {.gradients = 1e250 * gradients_of_waves<2>(x)}).components[0];
  EXPECT_NEAR((*f)(Point<2>(.5e-200, .5e-200)) / 1e50, waves<2>(Point<2>(.5, .5)), 1e-4);
}

TEST(FitWithDerivatives, NamesWhatIsWrong) {
  const Points<2> x = random_points<2>(30, 1);
  const Samples<2> data = sample<2>(x, waves<2>);
  const Eigen::MatrixXd g = gradients_of_waves<2>(x);
  expect_refusal([&] { fit<2>(data, {.gradients = g.leftCols(1)}); }, "one derivative by each coordinate");
  expect_refusal([&] { fit<2>(data, {.kernel = "cubic", .gradients = g}); }, "matern-c4");
  expect_refusal([&] { fit<2>(data, {.tolerance = 1, .gradients = g}); }, "cannot be combined");
}

// Slopes at the outermost samples hold beyond them, and deviations are those of that function.
TEST(FitWithDerivatives, GoesOnOutsideTheBox) {
  const Points<2> inside = (.2 + .6 * random_points<2>(60, 1).array()).matrix();
  const Fit<2> found = fit<2>(sample<2>(inside, waves<2>), {.gradients = gradients_of_waves<2>(inside)});
  const Points<2> x = (.1 + .8 * random_points<2>(500, 2).array()).matrix();
  const Eigen::ArrayXd error =
      (found.components[0]->evaluate(x).value - sample<2>(x, waves<2>).values.col(0)).cwiseAbs();
  const Eigen::ArrayXd deviation = found.variances[0]->evaluate(x).value.cwiseSqrt();
  EXPECT_LE(error.maxCoeff(), 1e-3);
  EXPECT_LE((error / deviation).maxCoeff(), 5);
}

// Derivatives without noise fit the covariance better than values with it.
TEST(FitWithDerivatives, MeasuresTheNoiseOfValuesBesideExactDerivatives) {
  const Points<2> x = random_points<2>(400, 1);
  Samples<2> data = sample<2>(x, waves<2>);
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (double& value : data.values.reshaped()) value += .1 * normal(random);
  EXPECT_NEAR(fit<2>(data, {.gradients = gradients_of_waves<2>(x)}).report.noise[0], .1, .012);
}

}  // namespace
}  // namespace csrbf::fit_with_derivatives_test
