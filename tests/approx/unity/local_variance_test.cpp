#include "csrbf/approx/unity/local_variance.hpp"

#include "approx/approx_testing.hpp"

namespace csrbf::local_variance_test {
namespace {

// Noise of standard deviation sigma on the left half, three times that on the right.
template <int Dim>
double noise_at(const Point<Dim>& p) {
  return p[0] < .5 ? .02 : .06;
}

template <int Dim>
Samples<Dim> noisy(Index n, unsigned seed) {
  Samples<Dim> data = sample<Dim>(random_points<Dim>(n, seed), waves<Dim>);
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0, 1);
  for (Index i = 0; i < n; ++i) data.values(i) += noise_at<Dim>(data.points.col(i)) * normal(random);
  return data;
}

template <int Dim>
void expect_noise_found() {
  const Samples<Dim> data = noisy<Dim>(6000, 1), others = noisy<Dim>(4000, 2);
  // Patches that tell the halves of space apart.
  const auto fit = partition_of_unity(
      data, {.degree = 2, .samples_per_patch = Dim < 3 ? 300 : 600, .centers_per_patch = 0, .smoothing = 0});
  const auto variance = local_variance(data, fit);
  ASSERT_EQ(variance.size(), 1U);
  const Eigen::ArrayXd error = (fit.fields()[0]->evaluate(others.points).value - others.values.col(0)).cwiseAbs();
  const Eigen::ArrayXd deviation = variance[0]->evaluate(others.points).value.cwiseSqrt();
  double left = 0, right = 0;
  for (Index i = 0; i < others.size(); ++i) {
    const double x = others.points(0, i);
    (x < .5 ? left : right) += x < .3 || x > .7 ? deviation[i] / (.2 * 4000 * 1.5) : 0;  // 30 % of the points each
  }
  EXPECT_NEAR(left, .02, (Dim < 3 ? .25 : .5) * .02) << Dim;
  EXPECT_NEAR(right, .06, .25 * .06) << Dim;
  const double covered = static_cast<double>((error <= 1.96 * deviation).count()) / 4000;
  EXPECT_GE(covered, Dim < 3 ? .92 : .88) << Dim;
  EXPECT_LE(covered, .98) << Dim;
}

TEST(LocalVariance, FindsTheNoiseWhereItIs) {
  expect_noise_found<1>();
  expect_noise_found<2>();
  expect_noise_found<3>();
}

// Of samples that differ in weight at every place.
TEST(LocalVariance, IsThatOfASampleOfMeanWeight) {
  Samples<2> data = sample<2>(random_points<2>(5000, 1), franke);
  data.weights = Eigen::VectorXd::Ones(5000);
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal(0, .2);
  for (Index i = 0; i < 5000; ++i) {
    if (i % 3 == 0) data.weights[i] = 8;
    data.values(i) += normal(random) / std::sqrt(data.weights[i]);
  }
  const auto fit = partition_of_unity(data, {.degree = 2, .samples_per_patch = 300, .centers_per_patch = 0});
  const Eigen::VectorXd variance = local_variance(data, fit)[0]->evaluate(data.points).value;
  const double expected = .2 / std::sqrt(data.weights.mean());
  EXPECT_NEAR(std::sqrt(variance.mean()), expected, .1 * expected);  // without weights: 1.55 times that
}

TEST(LocalVariance, WithoutNoiseIsThatOfSamplesLeftOut) {
  const Samples<2> data = sample<2>(random_points<2>(5000, 1), franke);
  const auto fit = partition_of_unity(data);
  const auto variance = local_variance(data, fit);
  const Points<2> x = (.05 + .9 * random_points<2>(3000, 2).array()).matrix();
  const Samples<2> truth = sample<2>(x, franke);
  const Eigen::ArrayXd error = (fit.fields()[0]->evaluate(x).value - truth.values.col(0)).cwiseAbs();
  const Eigen::ArrayXd deviation = variance[0]->evaluate(x).value.cwiseSqrt();
  EXPECT_GE(static_cast<double>((error <= 1.96 * deviation).count()) / 3000, .9);
  EXPECT_LE(std::sqrt(deviation.square().mean()), 10 * fit.report.cross_validation_rmse);
}

TEST(LocalVariance, IsThatOfEveryComponentInItsUnit) {
  Samples<2> data = noisy<2>(1500, 1);
  data.values.conservativeResize(Eigen::NoChange, 2);
  data.values.col(1) = 64 * data.values.col(0);
  data.weights = Eigen::VectorXd::LinSpaced(1500, .5, 1.5);
  data.weights[3] = 0;  // left out
  const auto variances = local_variance(data, partition_of_unity(data));
  const Points<2> x = random_points<2>(50, 2);
  const Eigen::VectorXd one = variances[0]->evaluate(x).value, other = variances[1]->evaluate(x).value;
  EXPECT_LE((other - 4096 * one).cwiseAbs().maxCoeff(), 1e-6 * other.maxCoeff());
  EXPECT_GT(one.minCoeff(), 0);
}

// Stations seen twice, at coordinates that are not quite the same: what one reading says of the other is no error.
TEST(LocalVariance, IsThatBetweenPlacesAndNotBetweenTwins) {
  constexpr Index places = 1500;
  Points<3> x(3, 2 * places);
  x << random_points<3>(places, 1), random_points<3>(places, 1) + 1e-6 * random_points<3>(places, 2);
  const Samples<3> data = sample<3>(x, waves<3>);
  const auto fit = partition_of_unity(data);
  const Points<3> at = random_points<3>(2000, 3);
  const Eigen::ArrayXd deviation = local_variance(data, fit)[0]->evaluate(at).value.array().sqrt();
  const Samples<3> truth = sample<3>(at, waves<3>);
  const Eigen::ArrayXd error = (fit.fields()[0]->evaluate(at).value - truth.values.col(0)).array().abs();
  EXPECT_GE((error <= 1.96 * deviation).count(), 1700);
  EXPECT_LE(std::sqrt(deviation.square().mean()), 10 * std::sqrt(error.square().mean()));
}

TEST(LocalVariance, TakesAFewSamplesAndConstantOnes) {
  for (const Index n : {1, 2, 7, 60}) {
    const Samples<3> data{random_points<3>(n, 1), Eigen::VectorXd::Constant(n, 5), {}};
    const Eigen::VectorXd value = local_variance(data, partition_of_unity(data))[0]->evaluate(data.points).value;
    EXPECT_TRUE((value.array() >= 0).all()) << n;
    EXPECT_LE(value.maxCoeff(), 1e-12) << n;
  }
}

// Far from a coast all errors are 0, and the next sample may be land.
TEST(LocalVariance, IsPositiveWhereValuesAreConstant) {
  const auto land = [](const Point<2>& x) { return x[0] < .6 ? 0.0 : 1 + std::sin(40 * x[0]) * std::sin(40 * x[1]); };
  const Samples<2> data = sample<2>(random_points<2>(2000, 1), land);
  const auto variance = local_variance(data, partition_of_unity(data, {.degree = 0, .samples_per_patch = 20}));
  const double at_sea = variance[0]->evaluate(Point<2>(.1, .5)).value[0];
  EXPECT_GT(at_sea, 0);
  EXPECT_LT(at_sea, variance[0]->evaluate(Point<2>(.6, .5)).value[0] / 20);
  const Samples<2> constant = sample<2>(data.points, [](const Point<2>&) { return 0.0; });
  EXPECT_EQ(local_variance(constant, partition_of_unity(constant))[0]->evaluate(Point<2>(.1, .5)).value[0], 0);
}

}  // namespace
}  // namespace csrbf::local_variance_test
