#include "csrbf/approx/fit.hpp"

#include "approx/approx_testing.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace csrbf::fit_few_test {
namespace {

// A trend with a wave of a period of twelve samples, as of the seasons.
double seasonal(double t) {
  return 2 * t * t + 0.1 * std::sin(2 * std::numbers::pi * t * 400 / 12);
}

// One covariance takes the wave beside the trend for noise; what is left out tells that it is none.
TEST(FitOfFewSamples, FollowsAWaveBesideATrend) {
  constexpr Index n = 400;
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0, 0.01);
  Samples<1> all{Points<1>(1, n), Eigen::MatrixXd(n, 1), {}};
  for (Index i = 0; i < n; ++i) {
    all.points(0, i) = static_cast<double>(i) / n;
    all.values(i, 0) = seasonal(all.points(0, i)) + noise(random);
  }
  std::vector<Index> kept, left_out;
  for (Index i = 0; i < n; ++i) (random() % 5 == 0 ? left_out : kept).push_back(i);
  const Samples<1> samples{all.points(Eigen::all, kept), all.values(kept, Eigen::all), {}};
  const Fit<1> result = fit<1>(samples);
  EXPECT_EQ(result.report.method, "partition-of-unity");
  const Points<1> x = all.points(Eigen::all, left_out);
  const Eigen::VectorXd value = result.components.at(0)->evaluate(x).value;
  double squares = 0;
  for (Index i = 0; i < x.cols(); ++i) squares += std::pow(value[i] - seasonal(x(0, i)), 2);
  EXPECT_LT(std::sqrt(squares / static_cast<double>(x.cols())), 0.03);

  // Noise stays noise.
  for (Index i = 0; i < samples.size(); ++i) all.values(i, 0) = 2 * samples.points(0, i) + 10 * noise(random);
  const Samples<1> noisy{samples.points, all.values.topRows(samples.size()), {}};
  EXPECT_EQ(fit<1>(noisy).report.method, "interpolate");
}

// The linear trend of the likeliest covariance is more than such samples determine.
TEST(FitOfFewSamples, TakesAnAxisWithOneCoordinate) {
  constexpr Index n = 50;
  Samples<2> data{Points<2>(2, n), Eigen::MatrixXd(n, 1), {}};
  for (Index i = 0; i < n; ++i) {
    const double x = 10 * static_cast<double>(i) / (n - 1);
    data.points.col(i) << x, 7;
    data.values(i, 0) = std::sin(x);
  }
  const Fit<2> found = fit<2>(data);
  EXPECT_NEAR(found.components[0]->evaluate(Point<2>(3.3, 7)).value[0], std::sin(3.3), 1e-3);
}

// Patches without polynomials and, as smoothing may choose, without radial functions are 0.
template <int Dim>
void expect_finite_without_polynomials() {
  for (const Index n : {3, 10, 60})
    for (const double smoothing : {1e-3, 10.0, 1e3}) {
      FitOptions options;
      options.method = "partition-of-unity";
      options.degree = -1;
      options.smoothing = smoothing;
      const Fit<Dim> result = fit<Dim>(
          sample<Dim>(random_points<Dim>(n, 1), [](const Point<Dim>& x) { return std::sin(7 * x[0]); }), options);
      EXPECT_TRUE(result.components[0]->evaluate(random_points<Dim>(100, 2)).value.allFinite())
          << n << " " << smoothing;
    }
}

TEST(FitOfFewSamples, IsFiniteWithoutPolynomials) {
  expect_finite_without_polynomials<1>();
  expect_finite_without_polynomials<2>();
}

}  // namespace
}  // namespace csrbf::fit_few_test
