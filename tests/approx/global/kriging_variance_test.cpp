#include "csrbf/approx/global/kriging_variance.hpp"

#include "approx/approx_testing.hpp"
#include "csrbf/approx/basis/expansion.hpp"
#include "csrbf/approx/basis/polynomial.hpp"
#include "csrbf/approx/global/interpolate.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <algorithm>

namespace csrbf::kriging_variance_test {
namespace {

constexpr double solved = 1e-9;  // of systems of condition below 1e6

template <int Dim>
std::shared_ptr<const RadialBasis<Dim>> basis(const char* kernel, const Points<Dim>& points, double support) {
  return std::make_shared<const RadialBasis<Dim>>(Kernel(kernel, Dim), points, Eigen::VectorXd::Constant(1, support));
}

// phi(0) + lambda - b^T M^-1 b by the inverse of the whole matrix.
template <int Dim>
Eigen::VectorXd by_definition(const RadialBasis<Dim>& basis, int degree, double lambda, const Eigen::VectorXd& weights,
                              const Points<Dim>& x) {
  const Polynomials<Dim> polynomials(degree);
  const Index n = basis.size(), Q = polynomials.size();
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(n + Q, n + Q), G(n, Q), g(x.cols(), Q);
  polynomials.rows(basis.centers(), G.data());
  polynomials.rows(x, g.data());
  M.topLeftCorner(n, n) = basis.dense_matrix(basis.centers());
  M.topLeftCorner(n, n).diagonal() += lambda * weights.cwiseInverse();
  M.topRightCorner(n, Q) = G;
  M.bottomLeftCorner(Q, n) = G.transpose();
  Eigen::MatrixXd b(n + Q, x.cols());
  b << basis.dense_matrix(x).transpose(), g.transpose();
  return (basis.kernel().value(0) + lambda - b.cwiseProduct(M.fullPivLu().solve(b)).colwise().sum().array())
      .transpose();
}

TEST(PowerFunction, IsThatOfItsDefinition) {
  const Points<2> points = random_points<2>(60, 1), x = random_points<2>(40, 2);
  const Eigen::VectorXd weights = Eigen::VectorXd::LinSpaced(60, .5, 1.5);
  for (const char* kernel : {"wendland-c2", "gaussian", "thin-plate", "cubic"})
    for (const double lambda : {0.0, .01}) {
      const auto phi = basis<2>(kernel, points, .15);
      const int degree = phi->kernel().order();
      const PowerFunction<2> power(phi, degree, lambda, weights);
      EXPECT_LE((power.evaluate(x) - by_definition<2>(*phi, degree, lambda, weights, x)).cwiseAbs().maxCoeff(),
                solved * std::max(1.0, phi->dense_matrix(points).cwiseAbs().maxCoeff()))
          << kernel << " " << lambda;
    }
  const auto phi = basis<2>("wendland-c2", points, .3);
  EXPECT_LE((PowerFunction<2>(phi, -1, 0, {}).evaluate(x) - by_definition<2>(*phi, -1, 0, Eigen::VectorXd::Ones(60), x))
                .cwiseAbs()
                .maxCoeff(),
            solved);
}

TEST(PowerFunction, IsTheSmoothingAtLeastAndZeroAtSamplesWithoutIt) {
  const Points<3> points = random_points<3>(80, 1);
  const auto phi = basis<3>("wendland-c2", points, .5);
  EXPECT_LE(PowerFunction<3>(phi, 0, 0, {}).evaluate(points).maxCoeff(), solved);
  const PowerFunction<3> smooth(phi, 0, .1, {});
  EXPECT_GE(smooth.evaluate(points).minCoeff(), .1);
  EXPECT_LE(smooth.evaluate(points).maxCoeff(), .2);  // a sample of the same place, the noise of both, tells less
}

TEST(PowerFunction, IsNotZeroWhereTheMatrixIsSingularToRounding) {
  const auto phi = basis<2>("gaussian", random_points<2>(300, 1), .5);
  Eigen::MatrixXd K = phi->dense_matrix(phi->centers());
  ASSERT_NE(K.llt().info(), Eigen::Success);
  const Eigen::VectorXd variance = PowerFunction<2>(phi, -1, 0, {}).evaluate(random_points<2>(100, 2));
  EXPECT_GT(variance.minCoeff(), 0);
  EXPECT_LT(variance.maxCoeff(), 1e-6);
}

TEST(PowerFunction, GrowsWithTheDistanceFromTheSamples) {
  Points<1> points(1, 20), x(1, 50);
  for (Index i = 0; i < 20; ++i) points(0, i) = static_cast<double>(i < 10 ? i : i + 10);  // a gap from 9 to 20
  for (Index i = 0; i < 50; ++i) x(0, i) = 9 + .11 * static_cast<double>(i);               // to its middle
  for (const char* kernel : {"wendland-c2", "gaussian", "cubic", "matern"}) {
    const auto phi = basis<1>(kernel, points, 4);
    const PowerFunction<1> power(phi, phi->kernel().order() - 1, 0, {});
    const Eigen::VectorXd value = power.evaluate(x);
    for (Index i = 1; i < 50; ++i) EXPECT_GE(value[i], value[i - 1] - solved) << kernel;
    EXPECT_GE(value[49], 10 * power.evaluate(Points<1>::Constant(1, 1, 5.5))[0]) << kernel;
  }
}

TEST(PowerFunction, IsZeroWhereThePolynomialTakesAllSamples) {
  Points<1> two(1, 2);
  two << 0, 1;
  const PowerFunction<1> power(basis<1>("thin-plate", two, 1), 1, 0, {});
  EXPECT_NEAR(power.evaluate(two).maxCoeff(), 0, solved);
}

// P^2 without a sample is what a power function without it has there.
TEST(PowerFunction, KnowsWhatIsUsualBetweenTheSamples) {
  const Points<2> points = random_points<2>(40, 1);
  const double lambda = .01;
  std::vector<double> without;
  for (Index i = 0; i < 40; ++i) {
    Points<2> others(2, 39);
    for (Index j = 0; j < 39; ++j) others.col(j) = points.col(j < i ? j : j + 1);
    const PowerFunction<2> power(basis<2>("wendland-c2", others, .5), 0, lambda, {});
    without.push_back(power.evaluate(points.col(i))[0] - lambda);
  }
  std::sort(without.begin(), without.end());
  const double usual = PowerFunction<2>(basis<2>("wendland-c2", points, .5), 0, lambda, {}).usual();
  EXPECT_GE(usual, without[34] - solved);
  EXPECT_LE(usual, without[36] + solved);
}

TEST(KrigingVariance, GrowsAsTold) {
  const auto power =
      std::make_shared<const PowerFunction<2>>(basis<2>("wendland-c2", unit_grid(6), 1.5), 0, .01, Eigen::VectorXd());
  Points<2> x(2, 200);
  x << random_points<2>(100, 1), 2 * random_points<2>(100, 2);
  const KrigingVariance<2> as_is(power, 3, {}), grown(power, 3, {}, {2, 10});
  const Eigen::VectorXd before = as_is.evaluate(x).value, after = grown.evaluate(x).value;
  const double usual = power->usual();
  Index beyond = 0;
  for (Index i = 0; i < x.cols(); ++i) {
    const double power2 = before[i] / 3 - .01, ratio = power2 / usual;
    const double factor = ratio <= 1 ? 1 : (ratio >= 2 ? 10 : std::pow(10, std::log2(ratio)));
    EXPECT_NEAR(after[i], 3 * (power2 * factor + .01), solved);
    beyond += ratio > 2 ? 1 : 0;
  }
  EXPECT_GT(beyond, 10);
  EXPECT_LT(beyond, 150);
}

// Random functions of Matern covariance at the columns of x, with noise: one per column.
Eigen::MatrixXd draws(const Points<2>& x, double support, double noise, Index count) {
  Eigen::MatrixXd K = basis<2>("matern", x, support)->dense_matrix(x);
  K.diagonal().array() += noise + 1e-12;
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal(0, 1);
  const Eigen::MatrixXd z = Eigen::MatrixXd::NullaryExpr(x.cols(), count, [&] { return normal(random); });
  return K.llt().matrixL() * z;
}

// Share of further samples within 1.96 standard deviations.
double coverage(const InterpolateOptions& options, double noise, double unit = 1) {
  constexpr Index known = 150, count = 12;
  const Points<2> x = random_points<2>(400, 3);
  const Eigen::MatrixXd values = 5 + unit * draws(x, .3, noise, count).array();
  const auto fit = interpolate<2>({x.leftCols(known), values.topRows(known), {}}, options);
  Index inside = 0;
  for (Index c = 0; c < count; ++c) {
    const auto i = static_cast<std::size_t>(c);
    const Points<2> others = x.rightCols(400 - known);
    const Eigen::ArrayXd error =
        (fit.components[i]->evaluate(others).value - values.col(c).tail(400 - known)).cwiseAbs();
    inside += (error <= 1.96 * fit.variances[i]->evaluate(others).value.array().sqrt()).count();
  }
  return static_cast<double>(inside) / static_cast<double>(count * (400 - known));
}

// 3000 errors, neighbours of which go together: a standard error of one to two hundredths.
TEST(KrigingVariance, CoversRandomFunctionsOfItsCovarianceAsOftenAsItSays) {
  const double exact = coverage({.kernel = "matern", .support = .3}, 0);
  EXPECT_GE(exact, .92);
  EXPECT_LE(exact, .98);
  const double noisy = coverage({.kernel = "matern", .support = .3, .smoothing = .05}, .05);
  EXPECT_GE(noisy, .92);
  EXPECT_LE(noisy, .98);
}

TEST(KrigingVariance, CoversThemNearlyAsOftenWithAChosenKernel) {
  EXPECT_GE(coverage({}, 0), .88);
  EXPECT_GE(coverage({.smoothing = {}}, .05), .88);
}

TEST(KrigingVariance, HasTheUnitOfTheValues) {
  EXPECT_EQ(coverage({.kernel = "matern", .support = .3}, 0, 1024), coverage({.kernel = "matern", .support = .3}, 0));
}

TEST(KrigingVariance, IsThatOfSparseSystemsToo) {
  const Samples<2> data = sample<2>(random_points<2>(1600, 1), franke);
  InterpolateOptions options{.kernel = "wendland-c2", .support = .12};
  const auto sparse = interpolate<2>(data, options);
  ASSERT_NE(sparse.report.solver, InterpolationSolver::dense);
  const Points<2> x = random_points<2>(100, 2);
  const Eigen::VectorXd deviation = sparse.variances[0]->evaluate(x).value.cwiseSqrt();
  EXPECT_GT(deviation.minCoeff(), 0);
  EXPECT_LE(sparse.variances[0]->evaluate(data.points).value.cwiseSqrt().maxCoeff(), 1e-3 * deviation.mean());
  options.dense_limit = 1500;
  EXPECT_TRUE(interpolate<2>(data, options).variances.empty());
}

TEST(KrigingVariance, IsUnknownForOneSample) {
  EXPECT_TRUE(interpolate<2>({Point<2>(1, 2), Eigen::MatrixXd::Constant(1, 1, 5), {}}).variances.empty());
}

TEST(PowerFunction, RefusesWeightsOfAnotherNumber) {
  expect_refusal(
      [] { PowerFunction<2>(basis<2>("gaussian", random_points<2>(5, 1), 1), 0, 0, Eigen::VectorXd::Ones(4)); },
      "PowerFunction: weights = 4");
}

}  // namespace
}  // namespace csrbf::kriging_variance_test
