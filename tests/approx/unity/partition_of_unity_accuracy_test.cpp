#include "approx/partition_testing.hpp"

#include <vector>

namespace csrbf::partition_of_unity_accuracy_test {
namespace {

// One random point in every cell of a grid: the largest gap halves with the cells. Gaps of uniformly random points
// shrink slower, by a power of log n.
template <int Dim>
Points<Dim> jittered_grid(Index per_axis) {
  Points<Dim> points = random_points<Dim>(static_cast<Index>(std::round(std::pow(per_axis, Dim))), 1);
  for (Index i = 0; i < points.cols(); ++i) {
    Index rest = i;
    for (int a = 0; a < Dim; ++a, rest /= per_axis)
      points(a, i) = (points(a, i) + static_cast<double>(rest % per_axis)) / static_cast<double>(per_axis);
  }
  return points;
}

// Mean order of convergence of the error inside, over refinements of the grid by `factor`. Doubling keeps the shapes of
// cells, which hold whole numbers of samples.
template <int Dim, class Function>
double observed_order(const PartitionOfUnityOptions& options, const Function& function, double first, double factor,
                      int refinements = 4) {
  std::vector<double> errors;
  for (int i = 0; i <= refinements; ++i) {
    const auto n = static_cast<Index>(std::round(first * std::pow(factor, i)));
    const auto f = partition_field<Dim>(sample<Dim>(jittered_grid<Dim>(n), function), options);
    const Points<Dim> inside = (0.1 + 0.8 * random_points<Dim>(2000, 2).array()).matrix();
    const Samples<Dim> truth = sample<Dim>(inside, function);
    errors.push_back((f->evaluate(truth.points).value - truth.values.col(0)).norm());
  }
  return std::log(errors.front() / errors.back()) / (refinements * std::log(factor));
}

constexpr double slack = 0.1;

PartitionOfUnityOptions interpolating(const char* kernel, int degree, Index samples) {
  return {
      .kernel = kernel, .degree = degree, .samples_per_patch = samples, .centers_per_patch = samples, .smoothing = 0};
}

TEST(PartitionOfUnityAccuracy, ConvergesWithDegreePlusOneInThePlane) {
  EXPECT_GE(observed_order<2>(interpolating("wendland-c0", 0, 20), waves<2>, 24, 2), 1 - slack);
  EXPECT_GE(observed_order<2>(interpolating("wendland-c2", 1, 30), waves<2>, 24, 2), 2 - slack);
  EXPECT_GE(observed_order<2>(interpolating("wendland-c4", 2, 50), waves<2>, 24, 2), 3 - slack);
  EXPECT_GE(observed_order<2>(interpolating("wendland-c6", 3, 50), waves<2>, 24, 2), 4 - slack);
}

// Coarser grids do not resolve Franke's function.
TEST(PartitionOfUnityAccuracy, ConvergesWithDegreePlusOneOnFrankesFunction) {
  EXPECT_GE(observed_order<2>(interpolating("wendland-c4", 2, 40), franke, 56, 2, 3), 3 - slack);
  EXPECT_GE(observed_order<2>(interpolating("wendland-c6", 3, 50), franke, 48, 2, 3), 4 - slack);
}

TEST(PartitionOfUnityAccuracy, ConvergesWithDegreePlusOneWithoutRadialFunctions) {
  for (int degree = 1; degree <= 3; ++degree) {
    const Index samples = 3 * Polynomials<2>::size(degree);
    const double order = observed_order<2>(
        {.degree = degree, .samples_per_patch = samples, .centers_per_patch = 0, .smoothing = 0}, waves<2>, 16, 2);
    EXPECT_GE(order, degree + 1 - slack) << degree;
  }
}

TEST(PartitionOfUnityAccuracy, ConvergesWithDegreePlusOneOnTheLineAndInSpace) {
  EXPECT_GE(observed_order<1>(interpolating("wendland-c4", 2, 12), waves<1>, 50, 2), 3 - slack);
  const auto half = [](const Point<3>& p) { return waves<3>(0.5 * p); };
  EXPECT_GE(observed_order<3>(interpolating("wendland-c2", 1, 40), half, 4, 2, 3), 2 - slack);
  EXPECT_GE(observed_order<3>(interpolating("wendland-c4", 2, 70), half, 4, 2, 3), 3 - slack);
}

Samples<2> noisy(Samples<2> data, double sigma) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> error(0, sigma);
  for (Index i = 0; i < data.size(); ++i) data.values(i) += error(random);
  return data;
}

TEST(PartitionOfUnityAccuracy, AveragesNoiseOutByItself) {
  const Samples<2> data = noisy(sample<2>(random_points<2>(20000, 1), franke), .01);
  const double interpolant = rms_error<2>(*partition_field<2>(data, interpolating("wendland-c4", 2, 40)), franke);
  EXPECT_LE(rms_error<2>(*partition_field<2>(data), franke), interpolant / 3);
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
}  // namespace csrbf::partition_of_unity_accuracy_test
