#include "csrbf/approx/kriging/fill_gaps.hpp"

#include "approx/approx_testing.hpp"
#include "csrbf/approx/basis/expansion.hpp"
#include "csrbf/approx/fit.hpp"
#include "csrbf/approx/global/interpolate.hpp"
#include "csrbf/approx/unity/local_variance.hpp"
#include "csrbf/approx/unity/partition_of_unity_field.hpp"
#include "csrbf/core/parallel.hpp"

namespace csrbf::fill_gaps_test {
namespace {

template <class Keep>
Samples<2> franke_where(Index n, unsigned seed, const Keep& keep) {
  const Points<2> all = random_points<2>(n, seed);
  std::vector<Index> chosen;
  for (Index i = 0; i < n; ++i)
    if (keep(Point<2>(all.col(i)))) chosen.push_back(i);
  return sample<2>(all(Eigen::all, chosen), franke);
}

bool in_triangle(const Point<2>& x) {
  return x.sum() < 1;
}

bool outside_hole(const Point<2>& x) {
  return (x.array() - .5).matrix().norm() > .3;
}

double rms(const Eigen::ArrayXd& x) {
  return std::sqrt(x.square().mean());
}

template <class Keep>
void expect_sane_in_gap(const Keep& keep, double largest_error) {
  const Samples<2> data = franke_where(6000, 1, keep);
  const Fit<2> fit = csrbf::fit(data);
  const Samples<2> gap = franke_where(
      4000, 2, [&](const Point<2>& x) { return !keep(x) && (x.array() < .97).all() && (x.array() > .03).all(); });
  const Eigen::ArrayXd error = fit.components[0]->evaluate(gap.points).value.array() - gap.values.col(0).array();
  EXPECT_LE(rms(error), largest_error);
  EXPECT_LE(error.abs().maxCoeff(), 1);  // the values are from 0 to 1.2
  const Eigen::ArrayXd deviation = fit.variances[0]->evaluate(gap.points).value.array().sqrt();
  EXPECT_GE(static_cast<double>((error.abs() <= 1.96 * deviation).count()), .75 * static_cast<double>(error.size()));
  EXPECT_LE(deviation.maxCoeff(), 1);
}

TEST(FillGaps, NothingExplodesInGaps) {
  expect_sane_in_gap(in_triangle, .25);   // without: 6.8; a thin plate: .12
  expect_sane_in_gap(outside_hole, .05);  // a thin plate: .04
}

// Of points on the faces of the box, too.
TEST(FillGaps, GivesTheSameBitsAgain) {
  const Samples<2> data = franke_where(1500, 1, outside_hole);
  const Points<2> x = random_points<2>(500, 3);
  const Eigen::VectorXd expected = csrbf::fit(data).components[0]->evaluate(x).value;
  for (const int threads : {1, 2, 3}) {
    set_thread_count(threads);
    std::vector<double> waste(1 << threads, threads);  // other memory
    EXPECT_EQ(csrbf::fit(data).components[0]->evaluate(x).value, expected) << threads << " " << waste.size();
  }
  set_thread_count(0);
}

TEST(FillGaps, TheDeviationGrowsWithTheDistanceToTheSamples) {
  const Fit<2> fit = csrbf::fit(franke_where(6000, 1, in_triangle));
  Points<2> x(2, 4);
  x << .4, .55, .7, .85, .4, .55, .7, .85;
  const Eigen::VectorXd variance = fit.variances[0]->evaluate(x).value;
  for (Index k = 1; k < x.cols(); ++k) EXPECT_GT(variance[k], 1.5 * variance[k - 1]) << k;
}

// Steps across many random lines: their sum has a linear variogram (Chentsov 1957).
Eigen::VectorXd rough(const Points<2>& x) {
  constexpr Index lines = 4000;
  const Points<2> random = random_points<2>(lines, 11);
  Eigen::VectorXd value = Eigen::VectorXd::Zero(x.cols());
  for (Index k = 0; k < lines; ++k) {
    const double angle = 6.283185307179586 * random(0, k), offset = 1.5 * random(1, k) - .75;
    const Eigen::ArrayXd side = (x.array() - .5).matrix().transpose() * Point<2>(std::cos(angle), std::sin(angle));
    value.array() += (side > offset).select(Eigen::ArrayXd::Constant(x.cols(), k % 2 == 0 ? 1 : -1), 0);
  }
  return value;
}

bool outside_block(const Point<2>& x) {
  return (x.array() - Eigen::Array2d(.6, .4)).abs().maxCoeff() > .12;
}

Samples<2> rough_where(Index n, unsigned seed, bool outside) {
  const Points<2> all = random_points<2>(n, seed);
  std::vector<Index> chosen;
  for (Index i = 0; i < n; ++i)
    if (outside_block(all.col(i)) == outside) chosen.push_back(i);
  const Points<2> x = all(Eigen::all, chosen);
  return {x, rough(x), {}};
}

TEST(FillGaps, RoughGapsAreFilledByOneSystem) {
  const Samples<2> data = rough_where(5000, 1, true), gap = rough_where(8000, 2, false);
  const auto patches = partition_of_unity(data);
  const FilledGaps<2> filled = fill_gaps(data, patches, local_variance(data, patches));
  ASSERT_EQ(filled.inside.size(), 1);
  EXPECT_GT(filled.fit.data->cover.size(), patches.data->cover.size());
  for (Index i = 0; i < filled.fit.data->cover.size(); ++i) EXPECT_FALSE(filled.fit.data->is_wide(i));
  const auto errors = [&](const Field<2>& field) -> Eigen::ArrayXd {
    return field.evaluate(gap.points).value.array() - gap.values.col(0).array();
  };
  const Interpolation<2> best = interpolate(data, {.kernel = "linear"});
  const Eigen::ArrayXd error = errors(*filled.fields()[0]);
  EXPECT_LE(rms(error), 1.02 * rms(errors(*best.components[0])));
  const Eigen::ArrayXd deviation = filled.variances[0]->evaluate(gap.points).value.array().sqrt();
  const double within =
      static_cast<double>((error.abs() <= 1.96 * deviation).count()) / static_cast<double>(error.size());
  EXPECT_GE(within, .85);
  EXPECT_LE(rms(deviation), 1.6 * rms(error));
}

// Waves of all lengths, with continuous slopes: local polynomials are strained already beside gaps.
TEST(FillGaps, DeviationsBesideGapsAreNoLargerThanThoseInThem) {
  constexpr Index waves = 1000;
  const Points<3> random = random_points<3>(waves, 12);
  const auto value = [&](const Point<2>& x) {
    double sum = 0;
    for (Index k = 0; k < waves; ++k) {
      const double frequency = 5 * std::pow(1 - random(0, k), -1. / 3), angle = 6.283185307179586 * random(1, k);
      sum += std::cos(frequency * (std::cos(angle) * x[0] + std::sin(angle) * x[1]) + 100 * random(2, k));
    }
    return std::sqrt(2. / waves) * sum;
  };
  const auto outside = [](const Point<2>& x) {
    return (x.array() - Eigen::Array2d(.3, .3)).abs().maxCoeff() > .05 &&
           (x.array() - Eigen::Array2d(.6, .8)).abs().maxCoeff() > .05 && x[0] + x[1] < 1.6;
  };
  const Points<2> all = random_points<2>(6000, 1), x = random_points<2>(6000, 2);
  std::vector<Index> kept;
  for (Index i = 0; i < all.cols(); ++i)
    if (outside(all.col(i))) kept.push_back(i);
  const Samples<2> data = sample<2>(all(Eigen::all, kept), value);
  const Fit<2> result = fit(data);
  const Eigen::ArrayXd error =
      result.components[0]->evaluate(x).value.array() - sample<2>(x, value).values.col(0).array();
  const Eigen::ArrayXd deviation = result.variances[0]->evaluate(x).value.array().sqrt();
  EXPECT_LE(rms(deviation), 3 * rms(error));
  EXPECT_GE(static_cast<double>((error.abs() <= 1.96 * deviation).count()), .9 * static_cast<double>(x.cols()));
}

// Waves of all lengths up to one, the longer the larger by a power.
Samples<2> waves_at(const Points<2>& x, double power) {
  constexpr Index waves = 600;
  const Points<3> random = random_points<3>(waves, 13);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(x.cols());
  for (Index k = 0; k < waves; ++k) {
    const double frequency = 5 * std::pow(1 - random(0, k), -1 / power), angle = 6.283185307179586 * random(1, k);
    sum.array() += (frequency * (std::cos(angle) * x.row(0) + std::sin(angle) * x.row(1)).array() + 100 * random(2, k))
                       .cos()
                       .transpose();
  }
  return {x, std::sqrt(2. / waves) * sum, {}};
}

// Blocks that twenty samples are missing from: too small for another function, and too wide for errors of samples that
// have neighbours.
TEST(FillGaps, DeviationsAreHonestInBlocksThatAreNoGap) {
  const auto in_block = [](const Point<2>& x) {
    const Index cell = 14 * static_cast<Index>(14 * x[0]) + static_cast<Index>(14 * x[1]);
    return cell * 37 % 101 < 10;
  };
  const Points<2> all = random_points<2>(4000, 1);
  std::vector<Index> kept, left_out;
  for (Index i = 0; i < all.cols(); ++i) (in_block(all.col(i)) ? left_out : kept).push_back(i);
  for (const double power : {1.5, 2.0, 3.0}) {
    const Fit<2> result = fit(waves_at(all(Eigen::all, kept), power), {.method = "partition-of-unity"});
    const Samples<2> blocks = waves_at(all(Eigen::all, left_out), power);
    const Eigen::ArrayXd error =
        result.components[0]->evaluate(blocks.points).value.array() - blocks.values.col(0).array();
    const Eigen::ArrayXd deviation = result.variances[0]->evaluate(blocks.points).value.array().sqrt();
    const double within =
        static_cast<double>((error.abs() <= 1.96 * deviation).count()) / static_cast<double>(error.size());
    EXPECT_GE(within, .85) << power;
    EXPECT_LE(rms(deviation), 3.5 * rms(error)) << power;  // of other waves .1 to 4.7
  }
}

TEST(FillGaps, TracksHaveFewerGaps) {
  const Samples<2> data = rough_where(5000, 1, true);
  const auto patches = partition_of_unity(data);
  const auto variance = local_variance(data, patches);
  const Points<2> x = random_points<2>(2000, 3);
  const auto share = [&](bool tracks) {
    const auto filled = fill_gaps(data, patches, variance, tracks);
    return filled.outside == nullptr ? 1 : filled.outside->evaluate(x).value.mean();
  };
  EXPECT_GT(share(true), share(false));
}

TEST(FillGaps, WithoutGapsNothingChanges) {
  Points<2> x(2, 3025);
  for (Index i = 0; i < x.cols(); ++i)
    x.col(i) = Point<2>(static_cast<double>(i % 55), static_cast<double>(i / 55)) / 54;
  const Samples<2> data = sample<2>(x, franke);
  const auto fit = partition_of_unity(data);
  const auto variance = local_variance(data, fit);
  const FilledGaps<2> filled = fill_gaps(data, fit, variance);
  EXPECT_EQ(filled.patches, 0);
  EXPECT_EQ(filled.fit.data, fit.data);
  EXPECT_EQ(filled.variances, variance);
}

// Random samples leave places that are farther from them than usual.
TEST(FillGaps, WithoutGapsDeviationsOnlyGrow) {
  const Samples<2> data = sample<2>(random_points<2>(3000, 1), franke);
  const auto fit = partition_of_unity(data);
  const auto variance = local_variance(data, fit);
  const FilledGaps<2> filled = fill_gaps(data, fit, variance);
  EXPECT_EQ(filled.patches, 0);
  EXPECT_EQ(filled.fit.data, fit.data);
  const Points<2> x = random_points<2>(2000, 3);
  const Eigen::ArrayXd ratio = filled.variances[0]->evaluate(x).value.array() / variance[0]->evaluate(x).value.array();
  EXPECT_GE((ratio == 1).count(), x.cols() / 2);
  EXPECT_GE(ratio.minCoeff(), 1);
  EXPECT_GE((ratio > 2).count(), x.cols() / 50);
}

TEST(FillGaps, AmongManySamplesWithNoiseChanceMakesNoGaps) {
  Samples<2> data = sample<2>(random_points<2>(40'000, 1), franke);
  data.values += .05 * random_points<1>(data.size(), 2).transpose();
  const auto fit = partition_of_unity(data, {.degree = 4, .samples_per_patch = 60, .centers_per_patch = 0});
  EXPECT_EQ(fill_gaps(data, fit, local_variance(data, fit)).patches, 0);
}

// Where the polynomials are dependent, what is squared of them must not lose its sign.
TEST(FillGaps, OnFewPlanesDeviationsAreNumbers) {
  Samples<3> data = sample<3>(random_points<3>(1100, 1), [](const Point<3>& x) { return std::sin(5 * x[0]); });
  data.points.row(2) = (4 * data.points.row(2).array()).floor();
  data.values += .1 * random_points<1>(data.size(), 2).transpose();
  const auto fit = partition_of_unity(data);
  const Eigen::VectorXd variance =
      fill_gaps(data, fit, local_variance(data, fit)).variances[0]->evaluate(data.points).value;
  EXPECT_GT(variance.minCoeff(), 0);
  EXPECT_TRUE(variance.allFinite());
}

TEST(FillGaps, FarFromAGapNothingChanges) {
  const Samples<2> data = franke_where(6000, 1, in_triangle);
  const auto fit = partition_of_unity(data);
  const FilledGaps<2> filled = fill_gaps(data, fit, local_variance(data, fit));
  ASSERT_GT(filled.patches, 0);
  Points<2> x = random_points<2>(500, 3);
  x.row(0) *= .25;
  x.row(1) *= .25;
  EXPECT_LE((filled.fit.fields()[0]->evaluate(x).value - fit.fields()[0]->evaluate(x).value).cwiseAbs().maxCoeff(),
            1e-12);
}

TEST(FillGaps, DerivativesAndGridsAreThoseOfTheValues) {
  const Samples<2> data = franke_where(6000, 1, in_triangle);
  const auto fit = partition_of_unity(data);
  const auto field = fill_gaps(data, fit, local_variance(data, fit)).fit.fields()[0];
  const Points<2> x = (.1 + .8 * random_points<2>(200, 4).array()).matrix();
  const Jet<2> jet = field->evaluate(x, Derivatives::gradient);
  constexpr double h = 1e-5;
  for (Index a = 0; a < 2; ++a) {
    Points<2> before = x, after = x;
    before.row(a).array() -= h;
    after.row(a).array() += h;
    const Eigen::VectorXd slope = (field->evaluate(after).value - field->evaluate(before).value) / (2 * h);
    const double size = slope.cwiseAbs().maxCoeff();
    EXPECT_LE((slope - jet.gradient.row(a).transpose()).cwiseAbs().maxCoeff(), 1e-4 * size);
  }
  const Eigen::VectorXd axis = Eigen::VectorXd::LinSpaced(40, 0, 1);
  const Eigen::VectorXd grid = field->evaluate_grid({axis, axis});
  Points<2> nodes(2, 1600);
  for (Index k = 0; k < 1600; ++k) nodes.col(k) = Point<2>(axis[k % 40], axis[k / 40]);
  EXPECT_LE((grid - field->evaluate(nodes).value).cwiseAbs().maxCoeff(), 1e-10);
}

TEST(FillGaps, DoesNotDependOnThreadsUnitsAndOffsets) {
  const Samples<2> data = franke_where(3000, 1, in_triangle);
  const Points<2> x = random_points<2>(300, 5);
  const int threads = thread_count();
  set_thread_count(1);
  const Eigen::VectorXd one = fit(data).components[0]->evaluate(x).value;
  set_thread_count(4);
  EXPECT_EQ(one, fit(data).components[0]->evaluate(x).value);
  set_thread_count(threads);
  Samples<2> scaled = data;
  scaled.points *= 1024;
  scaled.values *= 1e6;
  const Eigen::VectorXd other = fit(scaled).components[0]->evaluate((1024 * x).eval()).value / 1e6;
  EXPECT_LE((one - other).cwiseAbs().maxCoeff(), 1e-3);
}

// Samples of a step on nine tracks: most of them look as smooth as can be.
TEST(FillGaps, StaysNearTheSamplesOfAStepBetweenTracks) {
  constexpr Index n = 5000;
  for (const unsigned seed : {3U, 6U}) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(0, 1);
    Samples<2> data{Points<2>(2, n), Eigen::MatrixXd(n, 1), {}};
    for (Index i = 0; i < n; ++i) {
      const double x = uniform(random), track = std::round(8 * uniform(random)) / 8;
      double off = 0;
      for (int k = 0; k < 4; ++k) off += uniform(random) - 0.5;
      data.points.col(i) << x, track + 0.004 * off;
      data.values(i, 0) = data.points.col(i).sum() > 1 ? 1 : 0;
    }
    const Fit<2> found = csrbf::fit(data);
    EXPECT_LT((found.components[0]->evaluate(unit_grid(150)).value.array() - 0.5).abs().maxCoeff(), 10) << seed;
  }
}

}  // namespace
}  // namespace csrbf::fill_gaps_test
