#include "csrbf/approx/rbf_interpolator.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/parallel.hpp"

#include <gtest/gtest.h>
#include <Eigen/QR>

#include <algorithm>
#include <random>

namespace csrbf::rbf_interpolator_test {
namespace {

using Matrix = Eigen::MatrixXd;

constexpr double rounding = 1e-9;  // relative, with condition numbers up to about 1e6

Matrix random_points(Index d, Index n, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  return Matrix::NullaryExpr(d, n, [&] { return uniform(random); });
}

// Two components.
Matrix smooth_values(const Matrix& x) {
  Matrix values(2, x.cols());
  values.row(0) = (3 * x.row(0)).array().sin();
  values.row(1) = x.colwise().squaredNorm();
  return values;
}

TEST(RbfInterpolator, InterpolatesTheValuesAtThePoints) {
  const Matrix y = random_points(2, 60, 1);
  const Matrix s = smooth_values(y);
  for (const char* kernel : {"linear", "thin_plate_spline", "cubic", "multiquadric", "wendland-c2"}) {
    for (const Index neighbors : {0, 12}) {
      const RbfInterpolator f(y, s, {.neighbors = neighbors, .kernel = kernel, .epsilon = 3});
      EXPECT_LT((f.evaluate(y) - s).norm(), rounding * s.norm()) << kernel << " " << neighbors;
    }
  }
}

TEST(RbfInterpolator, ReproducesPolynomialsOfItsDegreeInAnyDimension) {
  for (const Index d : {1, 2, 3, 6, 8}) {
    const Matrix y = random_points(d, 80, 2);
    const Matrix x = 2 * random_points(d, 20, 3);
    const auto p = [](const Matrix& at) { return Matrix(2 * at.row(0) - at.bottomRows(1)); };
    for (const Index neighbors : {0, 30}) {
      const RbfInterpolator f(y, p(y), {.neighbors = neighbors});
      EXPECT_LT((f.evaluate(x) - p(x)).norm(), rounding * p(x).norm()) << d << " " << neighbors;
    }
  }
}

TEST(RbfInterpolator, WithNeighborsIsTheInterpolantOfTheNearestPoints) {
  for (const Index neighbors : {10, 200}) {
    const Matrix y = random_points(3, 300, 4);
    const Matrix s = smooth_values(y);
    Matrix x = random_points(3, 40, 5);
    x.rightCols(10) = x.col(0).replicate(1, 10);
    const Eigen::VectorXd smoothing = .01 * random_points(300, 1, 6);
    const Matrix found = RbfInterpolator(y, s, {.neighbors = neighbors, .smoothing = smoothing}).evaluate(x);
    for (Index i = 0; i < x.cols(); ++i) {
      std::vector<std::pair<double, Index>> nearest;
      for (Index j = 0; j < y.cols(); ++j) nearest.emplace_back((y.col(j) - x.col(i)).norm(), j);
      std::sort(nearest.begin(), nearest.end());
      std::vector<Index> list;
      for (Index j = 0; j < neighbors; ++j) list.push_back(nearest[j].second);
      const RbfInterpolator local(y(Eigen::all, list), s(Eigen::all, list), {.smoothing = smoothing(list)});
      EXPECT_LT((found.col(i) - local.evaluate(x.col(i))).norm(), rounding) << neighbors << " " << i;
    }
  }
}

TEST(RbfInterpolator, OfManyPointsMeetsThemAndIsRestored) {
  const Matrix y = random_points(2, 5000, 11);
  const Matrix s = smooth_values(y);
  for (const char* kernel : {"linear", "thin_plate_spline", "cubic"}) {
    const RbfInterpolatorOptions options{.kernel = kernel};
    const RbfInterpolator f(y, s, options);
    EXPECT_LT((f.evaluate(y) - s).cwiseAbs().maxCoeff(), 1e-7) << kernel;
    const Matrix x = random_points(2, 50, 12);
    EXPECT_LT((f.evaluate(x) - smooth_values(x)).cwiseAbs().maxCoeff(), 1e-2) << kernel;
    const RbfInterpolator again = RbfInterpolator::restore(y, f.coefficients(), options);
    EXPECT_EQ(again.evaluate(x), f.evaluate(x));
    Matrix nowhere = x;
    nowhere(0, 3) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_TRUE(f.evaluate(nowhere).col(3).array().isNaN().all());
  }
}

// A sum of smoothings, and values in common, as the dense system has them.
TEST(RbfInterpolator, OfManyPointsSolvesTheSameSystemWithPointsThatCoincide) {
  Matrix y = random_points(2, 4200, 13);
  y.rightCols(200) = y.leftCols(200);
  Matrix s = smooth_values(y);
  s.rightCols(200).array() += .1;
  Eigen::VectorXd smoothing = Eigen::VectorXd::Constant(4200, .01);
  smoothing.head(100).setZero();
  const RbfInterpolator f(y, s, {.smoothing = smoothing});
  const Matrix c = f.coefficients();
  const Eigen::VectorXd residual =
      (f.evaluate(y) - s).row(0).transpose() + smoothing.cwiseProduct(c.row(0).head(4200).transpose());
  EXPECT_LT(residual.cwiseAbs().maxCoeff(), 1e-7);
  EXPECT_LT(std::abs(c.row(0).head(4200).sum()), 1e-6);
  smoothing.setZero();
  EXPECT_THROW(RbfInterpolator(y, s, {.smoothing = smoothing}), SolverFailure);
}

TEST(RbfInterpolator, SmoothingTendsToTheLeastSquaresPolynomial) {
  const Matrix y = random_points(2, 50, 7);
  const Matrix s = smooth_values(y);
  Matrix G(50, 3);
  G << Eigen::VectorXd::Ones(50), y.transpose();
  const Matrix expected = (G * G.colPivHouseholderQr().solve(s.transpose())).transpose();
  constexpr double much = 1e9;
  const RbfInterpolator f(y, s, {.smoothing = Eigen::VectorXd::Constant(1, much)});
  EXPECT_LT((f.evaluate(y) - expected).norm(), 1e-6 * s.norm());
}

TEST(RbfInterpolator, SolvesSystemsThatAreNotPositiveDefinite) {
  const Matrix y = random_points(2, 40, 8);
  const Matrix s = smooth_values(y);
  for (const Index neighbors : {0, 10}) {
    const RbfInterpolator f(y, s, {.neighbors = neighbors, .kernel = "linear", .degree = -1});
    EXPECT_LT((f.evaluate(y) - s).norm(), rounding * s.norm());
  }
}

TEST(RbfInterpolator, GivesTheSameBitsForEveryNumberOfThreads) {
  const Matrix y = random_points(2, 300, 9);
  const Matrix x = random_points(2, 2000, 10);
  for (const Index neighbors : {0, 9}) {
    set_thread_count(1);
    const Matrix one = RbfInterpolator(y, smooth_values(y), {.neighbors = neighbors}).evaluate(x);
    set_thread_count(4);
    const Matrix four = RbfInterpolator(y, smooth_values(y), {.neighbors = neighbors}).evaluate(x);
    set_thread_count(0);
    EXPECT_EQ(one, four);
  }
}

TEST(RbfInterpolator, IsRestoredFromItsCoefficients) {
  const Matrix y = random_points(2, 30, 11);
  const RbfInterpolatorOptions options{.kernel = "quintic", .degree = 3};
  const RbfInterpolator f(y, smooth_values(y), options);
  EXPECT_EQ(RbfInterpolator::restore(y, f.coefficients(), options).evaluate(y), f.evaluate(y));
}

TEST(RbfInterpolator, StopsWhenProgressSaysSo) {
  const Matrix y = random_points(2, 30, 12);
  const RbfInterpolator f(y, smooth_values(y));
  EXPECT_THROW((void)f.evaluate(y, [](std::string_view, double) { return false; }), Cancelled);
}

template <class Error, class Call>
void expect_error(const Call& call, const std::string& part) {
  try {
    call();
    ADD_FAILURE() << "no error about " << part;
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

TEST(RbfInterpolator, RefusesWhatItCannotUse) {
  const Matrix y = random_points(2, 20, 13);
  const Matrix s = smooth_values(y);
  const auto refused = [&](const Matrix& points, const Matrix& values, const RbfInterpolatorOptions& options,
                           const char* part) {
    expect_error<InvalidInput>([&] { RbfInterpolator(points, values, options); }, part);
  };
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  refused(y, s.leftCols(3), {}, "one for each point");
  refused(Matrix::Constant(2, 20, nan), s, {}, "coordinate must be finite");
  refused(y, Matrix::Constant(2, 20, nan), {}, "value must be finite");
  refused(Matrix(2, 0), Matrix(2, 0), {}, "at least one point");
  refused(y, s, {.kernel = "magic"}, "thin-plate");
  refused(y, s, {.kernel = "gaussian"}, "needs a scale");
  refused(y, s, {.epsilon = nan}, "must be finite");
  refused(y, s, {.degree = -2}, "must be -1");
  refused(y, s, {.degree = 5}, "at least 21 points");
  refused(y, s, {.neighbors = 2}, "at least 3 points");
  refused(y, s, {.neighbors = -1}, "must not be negative");
  refused(y, s, {.smoothing = Eigen::VectorXd::Zero(7)}, "one for each point");
  refused(y, s, {.smoothing = Eigen::VectorXd::Constant(1, nan)}, "must be finite");
  const RbfInterpolator f(y, s, {.neighbors = 5});
  expect_error<InvalidInput>([&] { (void)f.evaluate(Matrix::Zero(3, 1)); }, "2 coordinates");
  expect_error<InvalidInput>([&] { (void)f.evaluate(Matrix::Constant(2, 1, nan)); }, "neighbors");
}

TEST(RbfInterpolator, SaysWhySystemsAreSingular) {
  const Matrix y = random_points(2, 20, 14);
  const Matrix twice = y.leftCols(10).replicate(1, 2);
  expect_error<SolverFailure>([&] { RbfInterpolator(twice, smooth_values(y)); }, "merge coincident points");
  const Matrix line = y.row(0).replicate(2, 1);
  expect_error<SolverFailure>([&] { RbfInterpolator(line, smooth_values(y)); }, "2 of its 3 coefficients");
  const RbfInterpolator local(twice, smooth_values(y), {.neighbors = 8});
  expect_error<SolverFailure>([&] { (void)local.evaluate(y); }, "merge coincident points");
}

}  // namespace
}  // namespace csrbf::rbf_interpolator_test
