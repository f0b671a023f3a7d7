#include "csrbf/approx/kriging/center_fit.hpp"

#include "approx/approx_testing.hpp"
#include "csrbf/approx/basis/expansion.hpp"
#include "csrbf/approx/fit.hpp"
#include "csrbf/approx/samples/mapped_field.hpp"
#include "csrbf/core/parallel.hpp"

#include <Eigen/QR>

namespace csrbf::center_fit_test {
namespace {

template <int Dim, class Function>
Samples<Dim> noisy(Index count, const Function& f, double deviation, unsigned seed = 5) {
  Samples<Dim> data = sample<Dim>(random_points<Dim>(count, 1), f);
  if (deviation == 0) return data;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0, deviation);
  for (double& value : data.values.reshaped()) value += normal(random);
  return data;
}

double smooth(const Point<3>& p) {
  return std::sin(3 * p[0]) * std::cos(2 * p[1]) + p[2] * p[2];
}

AxisCovariance<3> covariance() {
  return {Kernel("gaussian", 3), Point<3>(.5, .7, 1.0), 1e-2};
}

// Dense least squares with the same penalty.
TEST(CenterFit, IsPenalisedLeastSquares) {
  const Samples<3> data = noisy<3>(1500, smooth, 0.1);
  const auto fit = fit_at_centers(data, covariance());
  ASSERT_TRUE(fit);
  ASSERT_GE(fit->centers, 200);
  const auto& mapped = dynamic_cast<const MappedField<3>&>(*fit->components[0]);
  const auto& expansion = dynamic_cast<const Expansion<3>&>(mapped.inner());
  const Points<3> z = in_lengths<3>(data.points, covariance()), c = expansion.basis().centers();
  const Index m = c.cols(), n = z.cols();
  Eigen::MatrixXd D(n, m + 1), penalty = Eigen::MatrixXd::Zero(m + 1, m + 1);
  for (Index j = 0; j < m; ++j) {
    for (Index i = 0; i < n; ++i) D(i, j) = std::exp(-(z.col(i) - c.col(j)).squaredNorm());
    for (Index i = 0; i < m; ++i) penalty(i, j) = std::exp(-(c.col(i) - c.col(j)).squaredNorm());
  }
  D.col(m).setOnes();
  const Eigen::MatrixXd A = D.transpose() * D + fit->covariance.nugget * penalty;
  const Eigen::VectorXd fitted =
      D * A.completeOrthogonalDecomposition().solve(Eigen::VectorXd(D.transpose() * data.values));
  EXPECT_LE((fit->components[0]->evaluate(data.points).value - fitted).cwiseAbs().maxCoeff(), 1e-4);
}

TEST(CenterFit, KnowsNoiseAndDeviations) {
  const Samples<3> data = noisy<3>(4000, smooth, 0.1);
  const auto fit = fit_at_centers(data, covariance());
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->noise[0], 0.1, 0.003);
  EXPECT_NEAR(fit->error, 0.1, 0.005);
  const Points<3> x = random_points<3>(1000, 2);
  Eigen::ArrayXd error = fit->components[0]->evaluate(x).value;
  for (Index i = 0; i < x.cols(); ++i) error[i] -= smooth(x.col(i));
  const Eigen::ArrayXd variance = fit->variances[0]->evaluate(x).value.array() - fit->noise[0] * fit->noise[0];
  EXPECT_GE((error.abs() < 1.96 * variance.max(0).sqrt()).cast<double>().mean(), 0.85);
  EXPECT_LE(variance.mean(), 4 * error.square().mean());
}

TEST(CenterFit, CountsWeights) {
  Samples<3> data = noisy<3>(3000, smooth, 0.02);
  std::mt19937_64 random(9);
  std::normal_distribution<double> normal(0, 1);
  data.weights.setConstant(3000, 2500.0);
  for (Index i = 0; i < 3000; i += 2) {
    data.values(i, 0) += normal(random);
    data.weights[i] = 1;
  }
  data.weights *= 3000 / data.weights.sum();
  const auto fit = fit_at_centers(data, covariance());
  ASSERT_TRUE(fit);
  EXPECT_LE(rms_error<3>(*fit->components[0], smooth), 0.005);
}

TEST(CenterFit, DoesNotDependOnThreads) {
  const Samples<3> data = noisy<3>(3000, smooth, 0.1);
  set_thread_count(1);
  const auto one = fit_at_centers(data, covariance());
  set_thread_count(4);
  const auto four = fit_at_centers(data, covariance());
  set_thread_count(0);
  ASSERT_TRUE(one && four);
  const Points<3> x = random_points<3>(50, 2);
  EXPECT_EQ(one->components[0]->evaluate(x).value, four->components[0]->evaluate(x).value);
  EXPECT_EQ(one->variances[0]->evaluate(x).value, four->variances[0]->evaluate(x).value);
}

// A patch of a noisy smooth function sees few samples.
TEST(CenterFit, IsWhatFitTakesForNoisySmoothFunctions) {
  const Samples<3> data = noisy<3>(5000, smooth, 0.2);
  const Fit<3> all = fit<3>(data), patches = fit<3>(data, {.method = "partition-of-unity"});
  EXPECT_EQ(all.report.method, "interpolate");
  EXPECT_LT(all.report.centers, 2500);
  EXPECT_LE(rms_error<3>(*all.components[0], smooth), 0.75 * rms_error<3>(*patches.components[0], smooth));
  EXPECT_NEAR(all.report.noise[0], 0.2, 0.01);
  const Eigen::VectorXd variance = all.variances[0]->evaluate(random_points<3>(100, 3)).value;
  EXPECT_NEAR(std::sqrt(variance.mean()), 0.2, 0.02);
}

TEST(CenterFit, TakesOneLengthIfToldTo) {
  const Fit<3> result = fit<3>(noisy<3>(5000, smooth, 0.2), {.scale_axes = false});
  EXPECT_EQ(result.report.method, "interpolate");
  EXPECT_EQ(result.report.axis_scales, (std::vector<double>{1, 1, 1}));
}

// Its lengths are beyond the box: all that the samples tell is in the last digits of their covariances.
TEST(CenterFit, IsForPolynomialsToo) {
  const auto f = [](const Point<2>& p) { return 1 + 2 * p[0] - p[1] + 2 * p[0] * p[0] - 3 * p[0] * p[1]; };
  const Samples<2> everywhere = noisy<2>(6000, f, 0.1);
  std::vector<Index> rows;
  for (Index i = 0; i < everywhere.size(); ++i)
    if (everywhere.points.col(i).minCoeff() < 0.4) rows.push_back(i);
  const Fit<2> in_L = fit<2>(chosen_samples(everywhere, rows));
  EXPECT_EQ(in_L.report.method, "interpolate");
  EXPECT_LE(rms_error<2>(*in_L.components[0], f), 0.05);  // by patches: 0.3
  EXPECT_NEAR(in_L.report.noise[0], 0.1, 0.005);
}

// A tenth of the samples, left out, does not tell which is better.
TEST(CenterFit, IsWhatFitTakesInMuchNoise) {
  const auto f = [](const Point<2>& p) { return std::exp(p[0] - p[1]); };
  EXPECT_EQ(fit<2>(noisy<2>(3000, f, 0.4, 4)).report.method, "interpolate");
}

// Most samples tell nothing of a small bump.
TEST(CenterFit, KeepsLocalDetail) {
  const Point<2> middle(0.5, 0.5);
  const auto f = [&](const Point<2>& p) {
    return std::sin(3 * p[0]) + 0.3 * std::exp(-(p - middle).squaredNorm() / (2 * 0.04 * 0.04));
  };
  for (unsigned seed = 1; seed <= 2; ++seed) {
    const Fit<2> all = fit<2>(noisy<2>(12000, f, 0.1, seed));
    EXPECT_NEAR(all.components[0]->evaluate(Points<2>(middle)).value[0], f(middle), 0.15) << seed;
  }
}

// What is finer than so many centres resolve.
TEST(CenterFit, IsNotForFineFunctions) {
  const auto fine = [](const Point<2>& p) { return std::sin(90 * p[0]) * std::cos(80 * p[1]); };
  EXPECT_EQ(fit<2>(noisy<2>(20000, fine, 0.1)).report.method, "partition-of-unity");
}

}  // namespace
}  // namespace csrbf::center_fit_test
