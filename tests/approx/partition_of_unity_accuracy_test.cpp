#include "approx/partition_testing.hpp"

#include <numbers>

namespace csrbf {
namespace {

// Random samples have gaps that vary, so single ratios of errors scatter; the mean order over the range is asserted.
template <int Dim, class Function>
double observed_order(const PartitionOfUnityOptions& options, const Function& function, Index first, double factor) {
  constexpr int refinements = 4;
  double start = 0;
  double error = 0;
  double n = static_cast<double>(first);
  for (int i = 0; i <= refinements; ++i, n *= factor) {
    const auto f = partition_field<Dim>(sample<Dim>(random_points<Dim>(static_cast<Index>(n), 1), function), options);
    const Points<Dim> inside = (0.1 + 0.8 * random_points<Dim>(2000, 2).array()).matrix();
    const Samples<Dim> truth = sample<Dim>(inside, function);
    error = (f->evaluate(truth.points).value - truth.values.col(0)).norm();
    if (i == 0) start = error;
  }
  return std::log(start / error) / (refinements * std::log(factor) / Dim);
}

constexpr double slack = 0.1;

TEST(PartitionOfUnityAccuracy, ConvergesWithDegreePlusOneInThePlane) {
  const auto order = [](const char* kernel, int degree, Index samples) {
    return observed_order<2>({.kernel = kernel, .degree = degree, .samples_per_patch = samples, .smoothing = 0}, franke,
                             1000, 3);
  };
  EXPECT_GE(order("wendland-c0", 0, 20), 1 - slack);
  EXPECT_GE(order("wendland-c2", 1, 30), 2 - slack);
  EXPECT_GE(order("wendland-c4", 2, 40), 3 - slack);
  EXPECT_GE(order("wendland-c6", 3, 50), 4 - slack);
}

TEST(PartitionOfUnityAccuracy, ConvergesWithDegreePlusOneWithoutRadialFunctions) {
  for (int degree = 0; degree <= 4; ++degree) {
    const double order = observed_order<2>(
        {.degree = degree, .samples_per_patch = 3 * Polynomials<2>::size(degree), .centers_per_patch = 0}, franke, 2000,
        3);
    EXPECT_GE(order, degree + 1 - slack) << degree;
  }
}

TEST(PartitionOfUnityAccuracy, ConvergesWithDegreePlusOneOnTheLineAndInSpace) {
  EXPECT_GE(observed_order<1>({.kernel = "wendland-c4", .degree = 2, .samples_per_patch = 12, .smoothing = 0}, waves<1>,
                              100, 2),
            3 - slack);
  EXPECT_GE(observed_order<3>({.kernel = "wendland-c2", .degree = 1, .samples_per_patch = 40, .smoothing = 0}, waves<3>,
                              1000, 2.5),
            2 - slack);
  EXPECT_GE(observed_order<3>({.kernel = "wendland-c4", .degree = 2, .samples_per_patch = 50, .smoothing = 0}, waves<3>,
                              1000, 2.5),
            3 - slack);
}

Samples<2> noisy(Samples<2> data, double sigma) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> error(0, sigma);
  for (Index i = 0; i < data.size(); ++i) data.values(i) += error(random);
  return data;
}

TEST(PartitionOfUnityAccuracy, AveragesNoiseOutByItself) {
  const Samples<2> data = noisy(sample<2>(random_points<2>(20000, 1), franke), .01);
  const double interpolated = rms_error<2>(*partition_field<2>(data, {.smoothing = 0}), franke);
  const double automatic = rms_error<2>(*partition_field<2>(data), franke);
  const double plain = rms_error<2>(
      *partition_field<2>(data, {.kernel = "wendland-c4", .degree = 2, .samples_per_patch = 40, .smoothing = 0}),
      franke);
  EXPECT_LE(automatic, plain / 3);
  EXPECT_LE(automatic, interpolated * 1.05);
}

TEST(PartitionOfUnityAccuracy, MeetsExactValuesWithoutOptions) {
  const Samples<2> data = sample<2>(random_points<2>(20000, 1), franke);
  const auto f = partition_field<2>(data);
  EXPECT_LE(largest_error<2>(*f, data), 1e-6);
  EXPECT_LE(rms_error<2>(*f, franke), 1e-6);
}

// A cross-validation estimate cannot be far from the error it estimates.
TEST(PartitionOfUnityAccuracy, EstimatesItsErrorUnderNoise) {
  constexpr double sigma = .05;
  const auto fit = partition_of_unity<2>(noisy(sample<2>(random_points<2>(20000, 1), franke), sigma));
  EXPECT_NEAR(fit.report.cross_validation_rmse, sigma, 0.25 * sigma);
}

// Dense along straight tracks in two directions, with wide gaps between them: soundings, flight lines, altimetry.
Points<2> tracks(Index count, Index per_track) {
  Points<2> points(2, 2 * count * per_track);
  Index next = 0;
  for (const double slope : {.4, -.4})
    for (Index t = 0; t < count; ++t)
      for (Index i = 0; i < per_track; ++i, ++next) {
        const double x = (static_cast<double>(i) + .5) / static_cast<double>(per_track);
        points(0, next) = x;
        points(1, next) = 1.8 * (static_cast<double>(t) + .5) / static_cast<double>(count) - .4 + slope * (x - .5);
      }
  return points;
}

TEST(PartitionOfUnityAccuracy, StaysBoundedBetweenTracks) {
  const auto f = partition_field<2>(sample<2>(tracks(15, 600), franke));
  const Points<2> x = random_points<2>(20000, 2);
  const Eigen::VectorXd value = f->evaluate(x).value;
  EXPECT_LE(value.maxCoeff(), 1.4);  // the range is 0 to 1.22
  EXPECT_GE(value.minCoeff(), -.2);
  EXPECT_LE(rms_error<2>(*f, franke), 2e-2);
}

TEST(PartitionOfUnityAccuracy, FollowsDensitiesThatDifferGreatly) {
  Points<2> points = random_points<2>(6000, 1);
  points.leftCols(3000) = (.5 + 1e-3 * (points.leftCols(3000).array() - .5)).matrix();
  const auto function = [](const Point<2>& p) { return franke(p) + std::atan(2e3 * (p[0] - .5)); };
  const auto f = partition_field<2>(sample<2>(points, franke));
  EXPECT_LE(rms_error<2>(*f, franke), 1e-3);
  const auto steep = partition_field<2>(sample<2>(points, function));
  const Points<2> inner = (.5 + 8e-4 * (random_points<2>(500, 7).array() - .5)).matrix();
  EXPECT_LE(largest_error<2>(*steep, sample<2>(inner, function)), 1e-2);
}

}  // namespace
}  // namespace csrbf
