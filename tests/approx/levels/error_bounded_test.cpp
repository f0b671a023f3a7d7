#include "csrbf/approx/levels/error_bounded.hpp"

#include "approx/approx_testing.hpp"
#include "csrbf/approx/levels/level_sum.hpp"
#include "csrbf/approx/levels/pca_multiresolution.hpp"

namespace csrbf::error_bounded_test {
namespace {

constexpr double slack = 1e-12;  // of the range of the values: two sums of the same numbers

// Both methods promise the same bound.
template <int Dim>
using Method = LevelFit<Dim> (*)(const Samples<Dim>&, double tolerance);

template <int Dim>
LevelFit<Dim> by_farthest_points(const Samples<Dim>& samples, double tolerance) {
  return error_bounded<Dim>(samples, {.tolerance = tolerance});
}
template <int Dim>
LevelFit<Dim> by_clusters(const Samples<Dim>& samples, double tolerance) {
  return pca_multiresolution<Dim>(samples, {.tolerance = tolerance});
}

template <int Dim>
void expect_bound(const Samples<Dim>& data, double tolerance, const char* name) {
  const double range = data.values.maxCoeff() - data.values.minCoeff();
  for (const Method<Dim> method : {Method<Dim>(by_farthest_points<Dim>), Method<Dim>(by_clusters<Dim>)}) {
    const LevelFit<Dim> fit = method(data, tolerance);
    EXPECT_TRUE(fit.converged) << name << " " << Dim;
    for (Index c = 0; c < data.components(); ++c)
      EXPECT_LE(largest_error<Dim>(*fit.fields[c], data, c), tolerance + slack * range) << name << " " << Dim;
    EXPECT_LE(fit.last().max_error, tolerance + slack * range) << name << " " << Dim;
  }
}

// White noise: nothing to learn from the neighbours.
template <int Dim>
Samples<Dim> noise(const Points<Dim>& points, Index components, unsigned seed) {
  const Eigen::MatrixXd values = random_points<1>(points.cols() * components, seed);
  return {points, values.reshaped(points.cols(), components), {}};
}

template <int Dim>
void expect_bounds_for_adversaries() {
  Points<Dim> clustered = random_points<Dim>(150, 2);
  for (Index i = 0; i < 150; ++i) clustered.col(i) = std::pow(10.0, -static_cast<double>(i % 6)) * clustered.col(i);
  Points<Dim> line = Points<Dim>::Zero(Dim, 100);
  line.row(0) = random_points<1>(100, 3);
  for (const double tolerance : {.3, .01, 0.0}) {
    expect_bound<Dim>(noise<Dim>(random_points<Dim>(150, 1), 2, 4), tolerance, "uniform");
    expect_bound<Dim>(noise<Dim>(clustered, 1, 5), tolerance, "clustered");
    expect_bound<Dim>(noise<Dim>(line, 1, 6), tolerance, "collinear");
    expect_bound<Dim>(noise<Dim>(random_points<Dim>(1, 1), 1, 4), tolerance, "one sample");
    expect_bound<Dim>(noise<Dim>(random_points<Dim>(2, 1), 1, 4), tolerance, "two samples");
    expect_bound<Dim>(sample<Dim>(random_points<Dim>(200, 7), waves<Dim>), tolerance, "smooth");
  }
  // Twice at each point, with values 0.2 apart.
  Samples<Dim> twice = noise<Dim>(random_points<Dim>(100, 8), 1, 9);
  twice.points.rightCols(50) = twice.points.leftCols(50);
  twice.values.bottomRows(50) = twice.values.topRows(50).array() + .2;
  for (const double tolerance : {.2, .11}) expect_bound<Dim>(twice, tolerance, "twice");
}

TEST(ErrorBounded, KeepsTheBoundAtEverySampleOfAdversarialData1D) {
  expect_bounds_for_adversaries<1>();
}
TEST(ErrorBounded, KeepsTheBoundAtEverySampleOfAdversarialData2D) {
  expect_bounds_for_adversaries<2>();
}
TEST(ErrorBounded, KeepsTheBoundAtEverySampleOfAdversarialData3D) {
  expect_bounds_for_adversaries<3>();
}
TEST(ErrorBounded, KeepsTheBoundAtEverySampleOfAdversarialData4D) {
  expect_bounds_for_adversaries<4>();
}
TEST(ErrorBounded, KeepsTheBoundAtEverySampleOfAdversarialData5D) {
  expect_bounds_for_adversaries<5>();
}
TEST(ErrorBounded, KeepsTheBoundAtEverySampleOfAdversarialData6D) {
  expect_bounds_for_adversaries<6>();
}

// 1 % of the range: eps = .144 in the published example.
TEST(ErrorBounded, FitsPeaksWithFarFewerCentresThanSamples) {
  const Samples<2> data = sample<2>(random_points<2>(2000, 1), peaks);
  const auto fit = error_bounded<2>(data);
  EXPECT_TRUE(fit.converged);
  EXPECT_LE(largest_error<2>(*fit.fields[0], data), .0101 * 14.5);
  Index centers = 0;
  for (const LevelReport& level : fit.levels) centers += level.centers;
  EXPECT_LT(centers, 700);
  EXPECT_LT(rms_error<2>(*fit.fields[0], peaks), .1);
}

TEST(ErrorBounded, ShrinksTheErrorFromLevelToLevel) {
  const auto fit = error_bounded<2>(sample<2>(random_points<2>(2000, 1), peaks), {.tolerance = .01});
  ASSERT_GE(fit.levels.size(), 3u);
  EXPECT_LT(fit.last().max_error, .1 * fit.levels[0].max_error);
  for (std::size_t level = 1; level < fit.levels.size(); ++level)
    EXPECT_LT(fit.levels[level].smallest_support, fit.levels[level - 1].largest_support);
}

TEST(ErrorBounded, IsOneConstantForConstantData) {
  const auto fit = error_bounded<2>(sample<2>(random_points<2>(100, 1), [](const Point<2>&) { return -3.0; }));
  EXPECT_TRUE(fit.converged);
  EXPECT_EQ((*fit.fields[0])(Point<2>(.5, .5)), -3);
}

TEST(ErrorBounded, SaysThatDuplicatesWithDistantValuesAllowNoFunction) {
  Samples<2> data = noise<2>(random_points<2>(10, 1), 1, 2);
  data.points.col(9) = data.points.col(0);
  data.values(0) = 1;
  data.values(9) = 2;
  for (const Method<2> method : {Method<2>(by_farthest_points<2>), Method<2>(by_clusters<2>)}) {
    try {
      method(data, .25);
      FAIL();
    } catch (const SolverFailure& error) {
      EXPECT_NE(std::string(error.what())
                    .find("tolerance = 0.25: samples at the same point differ by 1, so no function is within it; allow "
                          "at least 0.5 or merge them"),
                std::string::npos);
    }
  }
}

TEST(ErrorBounded, SaysThatValuesDoNotHaveTheDigitsOfTheTolerance) {
  Samples<2> data = noise<2>(random_points<2>(60, 1), 1, 2);
  data.values *= 1e20;
  for (const Method<2> method : {Method<2>(by_farthest_points<2>), Method<2>(by_clusters<2>)}) {
    EXPECT_THROW(method(data, 1), SolverFailure);
    EXPECT_NO_THROW(method(data, 1e7));
  }
}

TEST(ErrorBounded, RefusesBadOptions) {
  const Samples<2> data = sample<2>(random_points<2>(10, 1), franke);
  EXPECT_THROW(error_bounded<2>(data, {.tolerance = -1}), InvalidInput);
  EXPECT_THROW(error_bounded<2>(data, {.tolerance = std::nan("")}), InvalidInput);
  EXPECT_THROW(error_bounded<2>(data, {.centers = -1}), InvalidInput);
  EXPECT_THROW(error_bounded<2>(data, {.support = 1}), InvalidInput);
  EXPECT_THROW(error_bounded<2>(data, {.reduction = 1}), InvalidInput);
}

}  // namespace
}  // namespace csrbf::error_bounded_test
