#include "approx/approx_testing.hpp"
#include "csrbf/approx/choose_model.hpp"
#include "csrbf/approx/fit.hpp"

namespace csrbf::fit_in_stages_test {
namespace {

template <int Dim>
double wave(const Point<Dim>& x) {
  return std::sin(9 * x[0] + 4 * x[1]) * std::cos(5 * x[Dim - 1]);
}

// Root mean square error among the samples.
template <int Dim, class Function>
double error(const Fit<Dim>& fit, const Function& f) {
  const Points<Dim> x = .05 + .9 * random_points<Dim>(500, 2).array();
  Eigen::VectorXd difference = fit.components[0]->evaluate(x).value;
  for (Index i = 0; i < x.cols(); ++i) difference[i] -= f(x.col(i));
  return difference.norm() / std::sqrt(500.0);
}

// Patches alone: 5e-5.
TEST(FitInStages, OneSystemKnowsMoreOfSmoothFunctionsThanPatches) {
  const Fit<3> space = fit<3>(sample<3>(random_points<3>(6000, 1), wave<3>));
  EXPECT_EQ(space.report.method, "interpolate");
  EXPECT_LE(error(space, wave<3>), 1e-6);
  EXPECT_LE(space.report.cross_validation_rmse, 1e-5);
}

// Neighbours in the lengths of such a function are a singular system: samples spread over all tell its error.
TEST(FitInStages, OneSystemOfFunctionsThatChangeAlongOneDirection) {
  const auto ridge = [](const Point<3>& x) { return std::tanh(.8 * x[0] + .5 * x[1] - .33 * x[2] - .4); };
  const Samples<3> samples = sample<3>(random_points<3>(3500, 1), ridge);
  const auto choice = choose_model<3>(samples, {}, {}, FitMethod::partition_of_unity);
  EXPECT_EQ(choice.method, FitMethod::interpolate);
  EXPECT_FALSE(choice.thinned.empty());
}

// A narrow peak spoils what one system knows of the wave around it.
TEST(FitInStages, PatchesAloneWhereTheyKnowMore) {
  for (const double width : {.1, .03}) {
    const auto f = [&](const Point<2>& x) {
      return wave<2>(x) + std::exp(-(x.array() - .4).square().sum() / (width * width));
    };
    const Samples<2> samples = sample<2>(random_points<2>(5000, 1), f);
    const Fit<2> best = fit<2>(samples), patches = fit<2>(samples, {.method = "partition-of-unity"});
    EXPECT_EQ(best.report.method, width > .05 ? "interpolate" : "partition-of-unity");
    EXPECT_LE(error(best, f), (width > .05 ? .2 : 1) * error(patches, f)) << width;
  }
}

// Patches around a hole know little of it: error 6e-4.
TEST(FitInStages, OneSystemInGapsOfManySamples) {
  const auto f = [](const Point<2>& x) { return std::sin(5 * x[0]) * std::cos(4 * x[1]); };
  const auto is_in_hole = [](const Point<2>& x) { return (x.array() - .5).matrix().norm() < .3; };
  const auto points = [&](Index count, unsigned seed, bool in_hole) {
    const Points<2> all = random_points<2>(4 * count, seed);
    std::vector<Index> chosen;
    for (Index i = 0; i < all.cols() && std::ssize(chosen) < count; ++i)
      if (is_in_hole(all.col(i)) == in_hole) chosen.push_back(i);
    return Points<2>(all(Eigen::all, chosen));
  };
  const Fit<2> fit = csrbf::fit<2>(sample<2>(points(5200, 1, false), f));
  EXPECT_EQ(fit.report.method, "partition-of-unity");
  const Points<2> x = points(200, 2, true);
  Eigen::VectorXd difference = fit.components[0]->evaluate(x).value;
  for (Index i = 0; i < x.cols(); ++i) difference[i] -= f(x.col(i));
  const Eigen::VectorXd variance = fit.variances[0]->evaluate(x).value;
  EXPECT_LE(difference.norm() / std::sqrt(200.0), 2e-5);
  EXPECT_GE((difference.array().square() < 1.96 * 1.96 * variance.array()).count(), 160);
  EXPECT_LE(variance.maxCoeff(), 1e-6);
}

// The samples that count are all in the one system.
TEST(FitInStages, SamplesOfNoWeight) {
  Samples<3> samples = sample<3>(random_points<3>(3000, 1), wave<3>);
  samples.weights = Eigen::VectorXd::Ones(3000);
  samples.weights.tail(1500).setZero();
  samples.values.bottomRows(1500).setConstant(7);
  const Fit<3> fit = csrbf::fit<3>(samples);
  EXPECT_LE(error(fit, wave<3>), 1e-4);
  EXPECT_LE(fit.report.cross_validation_rmse, 1e-3);
}

TEST(FitInStages, SeveralVariables) {
  const auto f = [](const Point<4>& x) { return std::sin(3 * x[0]) * std::cos(2 * x[1]) + x[2] * x[3]; };
  for (const Index n : {2600, 4100}) {
    const Fit<4> fit = csrbf::fit<4>(sample<4>(random_points<4>(n, 1), f));
    EXPECT_EQ(fit.report.method, "interpolate") << n;
    EXPECT_LE(error(fit, f), 1e-5) << n;
    // A corner is farther from the samples than the middle.
    const Points<4> corner = Points<4>::Constant(4, 1, 1), middle = Points<4>::Constant(4, 1, .5);
    EXPECT_GT(fit.variances[0]->evaluate(corner).value[0], 4 * fit.variances[0]->evaluate(middle).value[0]) << n;
  }
}

// Beyond the box of samples with tails a trend that holds is followed, as it is by few samples.
TEST(FitInStages, BeyondTheBoxOfManyVariables) {
  Points<4> x = random_points<4>(3000, 1) + random_points<4>(3000, 2) + random_points<4>(3000, 3);
  const auto f = [](const Point<4>& p) { return std::sin(p[0]) + p[1] * p[2] - p[3]; };
  const Fit<4> fit = csrbf::fit<4>(sample<4>(x, f));
  Points<4> outside = Points<4>::Constant(4, 1, 1.5);
  outside(1, 0) = x.row(1).maxCoeff() + .1;
  EXPECT_NEAR(fit.components[0]->evaluate(outside).value[0], f(outside.col(0)), 1e-3);
}

}  // namespace
}  // namespace csrbf::fit_in_stages_test
