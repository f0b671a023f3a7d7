#include "csrbf/approx/moving/track_directions.hpp"

#include "approx/approx_testing.hpp"
#include "csrbf/approx/fit.hpp"
#include "csrbf/approx/moving/moving_least_squares.hpp"

namespace csrbf::along_tracks_test {
namespace {

// Soundings of a rough ground along crossing lines, each with an offset of its own.
Samples<2> soundings(Index count, double offset) {
  constexpr Index lines = 60;
  const Points<2> begin = random_points<2>(lines, 1), end = random_points<2>(lines, 2);
  const Points<2> random = random_points<2>(count, 3);
  std::mt19937_64 seed(4);
  std::normal_distribution<double> normal;
  Eigen::VectorXd offsets(lines);
  for (double& x : offsets) x = offset * normal(seed);
  Points<2> points(2, count);
  Eigen::VectorXd added(count);
  for (Index i = 0; i < count; ++i) {
    const auto line = static_cast<Index>(random(1, i) * lines);
    points.col(i) = begin.col(line) + random(0, i) * (end - begin).col(line);
    added[i] = offsets[line];
  }
  Samples<2> samples = sample<2>(points, fractal);
  samples.values += added;
  return samples;
}

TEST(TrackDirections, AreThoseOfTheLines) {
  // Two lines that cross far from most samples, and one sample away from both.
  Points<2> points(2, 81);
  for (Index i = 0; i < 40; ++i) {
    points.col(i) = Point<2>(0.5 * static_cast<double>(i), 3);
    points.col(40 + i) = Point<2>(50, 0.25 * static_cast<double>(i));
  }
  points.col(80) = Point<2>(80, 40);
  const Points<2> directions = track_directions<2>(points, KdTree<2>(points));
  for (Index i = 1; i < 39; ++i) {
    EXPECT_NEAR(std::abs(directions(0, i)), 1, 1e-12) << i;
    EXPECT_NEAR(std::abs(directions(1, 40 + i)), 1, 1e-12) << i;
  }
  EXPECT_TRUE(directions.col(80).isZero());
}

TEST(MovingLeastSquaresAlongTracks, HasTrueDerivatives) {
  const Samples<2> plane = sample<2>(random_points<2>(400, 1), franke);
  expect_true_derivatives<2>(*moving_least_squares<2>(plane, {.tracks = true})[0], random_points<2>(30, 3), 1e-6, 1e-3);
  const Samples<3> space = sample<3>(random_points<3>(600, 1), waves<3>);
  expect_true_derivatives<3>(*moving_least_squares<3>(space, {.tracks = true})[0], random_points<3>(20, 3), 1e-6, 1e-3);
}

TEST(MovingLeastSquaresAlongTracks, AllButMeetsTheSamples) {
  const Samples<2> data = soundings(4000, 0.4);
  const Eigen::VectorXd value = moving_least_squares<2>(data, {.tracks = true})[0]->evaluate(data.points).value;
  EXPECT_LT((value - data.values.col(0)).cwiseAbs().mean(), 0.01);
}

TEST(MovingLeastSquaresAlongTracks, ReproducesConstantsAndRefusesOtherDegrees) {
  Samples<2> data = soundings(2000, 0);
  data.values.setConstant(3);
  const Eigen::VectorXd value =
      moving_least_squares<2>(data, {.tracks = true})[0]->evaluate(random_points<2>(200, 5)).value;
  EXPECT_LT((value.array() - 3).abs().maxCoeff(), 1e-12);
  EXPECT_THROW((void)moving_least_squares<2>(data, {.degree = 2, .tracks = true}), InvalidInput);
}

TEST(FitAlongTracks, IsChosenWhereTracksDisagree) {
  Samples<2> data = soundings(7000, 0.4);
  EXPECT_EQ(fit<2>(data).report.method, "along-tracks");
  data.points = random_points<2>(7000, 7);
  EXPECT_NE(fit<2>(data).report.method, "along-tracks");
}

TEST(FitAlongTracks, IsNotChosenForRoundingErrors) {
  Samples<2> constant = soundings(3000, 0.4);
  constant.values.setConstant(3.5);
  const auto result = fit<2>(constant);
  EXPECT_EQ(result.report.method, "partition-of-unity");
  EXPECT_LT(result.report.cross_validation_rmse, 1e-12);
}

// Every fifth sounding predicted by the others.
double mean_error_over_that_of_patches(double offset) {
  const Samples<2> all = soundings(8000, offset);
  const auto kept = Eigen::seqN(0, 6400), rest = Eigen::seqN(6400, 1600);
  const Samples<2> data{all.points(Eigen::all, kept), all.values(kept, Eigen::all), {}};
  const Points<2> x = all.points(Eigen::all, rest);
  const auto mean_error = [&](const FitOptions& options) {
    const Eigen::VectorXd value = fit<2>(data, options).components[0]->evaluate(x).value;
    return (value - all.values(rest, 0)).cwiseAbs().mean();
  };
  return mean_error({}) / mean_error({.method = "partition-of-unity"});
}

TEST(FitAlongTracks, PredictsSoundingsBetterThanPatches) {
  EXPECT_LT(mean_error_over_that_of_patches(0.4), 0.9);
  EXPECT_LT(mean_error_over_that_of_patches(0), 1.01);  // the tracks agree
}

// Deviations of left-out soundings, and of the ground in a gap that was left out.
TEST(FitAlongTracks, KnowsHowWrongItMayBe) {
  const Samples<2> all = soundings(10000, 0.4);
  const Point<2> middle(.5, .5);
  std::vector<Index> kept, near, gap;
  for (Index i = 0; i < all.size(); ++i)
    ((all.points.col(i) - middle).norm() < .12 ? gap : i % 5 == 0 ? near : kept).push_back(i);
  const auto result = fit<2>({all.points(Eigen::all, kept), all.values(kept, Eigen::all), {}});
  ASSERT_EQ(result.report.method, "along-tracks");
  ASSERT_EQ(result.variances.size(), 1U);
  const auto compare = [&](const std::vector<Index>& ids) {
    const Points<2> x = all.points(Eigen::all, ids);
    const Eigen::ArrayXd error = result.components[0]->evaluate(x).value - all.values(ids, 0);
    const Eigen::ArrayXd deviation = result.variances[0]->evaluate(x).value.array().sqrt();
    const double within = (error.abs() < 1.96 * deviation).cast<double>().mean();
    EXPECT_GT(within, .75);
    EXPECT_LT(error.abs().maxCoeff(), 4);  // the values are from -4 to 4
    return deviation.mean();
  };
  EXPECT_GT(compare(gap), 1.5 * compare(near));
}

}  // namespace
}  // namespace csrbf::along_tracks_test
