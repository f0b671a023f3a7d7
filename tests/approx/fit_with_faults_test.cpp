#include "csrbf/approx/fit_with_faults.hpp"

#include "approx/approx_testing.hpp"
#include "csrbf/approx/fit.hpp"

namespace csrbf::fit_with_faults_test {
namespace {

// A bent fault through the unit square.
Eigen::Matrix2Xd through() {
  Eigen::Matrix2Xd line(2, 3);
  line << .4, .5, .6, -.1, .5, 1.1;
  return line;
}

// Whether p is on the right of it.
bool is_right(const Point<2>& p) {
  return p[0] > .5 + (p[1] - .5) / 6;
}

double stepped(const Point<2>& p) {
  return waves<2>(p) + (is_right(p) ? 3 : 0);
}

TEST(FitWithFaults, KeepsAStepThatOthersSmear) {
  for (const Index n : {200, 3000}) {
    const Samples<2> data = sample<2>(random_points<2>(n, 1), stepped);
    const Fit<2> without = fit<2>(data), with = fit<2>(data, {.faults = {through()}});
    const double error = rms_error<2>(*with.components[0], stepped);
    EXPECT_LE(error, n > 1000 ? 1e-4 : .03);
    EXPECT_LE(error, .1 * rms_error<2>(*without.components[0], stepped));
    EXPECT_LE(with.report.max_error, .01);
  }
}

TEST(FitWithFaults, HasDifferentLimitsOnBothSides) {
  const auto f = fit<2>(sample<2>(random_points<2>(3000, 1), stepped), {.faults = {through()}}).components[0];
  const Point<2> left(.5 - 1e-9, .5), right(.5 + 1e-9, .5);
  EXPECT_NEAR((*f)(right) - (*f)(left), 3, 1e-3);
  expect_true_derivatives<2>(*f, Points<2>(Point<2>(.52, .5)), 1e-5, 1e-3);
}

TEST(FitWithFaults, IsContinuousAroundTheEndOfAFault) {
  // The angle about the end (.5, .5) of a fault that comes from below: jumps by 2 pi across it.
  const auto turn = [](const Point<2>& p) { return std::atan2(p[0] - .5, p[1] - .5); };
  Eigen::Matrix2Xd line(2, 2);
  line << .5, .5, -1, .5;
  const auto f = fit<2>(sample<2>(random_points<2>(4000, 1), turn), {.faults = {line}}).components[0];
  double largest = 0, error = 0;
  double before = (*f)(Point<2>(.5 + .2 * std::sin(-3.1), .5 + .2 * std::cos(3.1)));
  for (double angle = -3.1; angle <= 3.1; angle += .005) {
    const double value = (*f)(Point<2>(.5 + .2 * std::sin(angle), .5 + .2 * std::cos(angle)));
    largest = std::max(largest, std::abs(value - before));
    error = std::max(error, std::abs(value - angle));
    before = value;
  }
  EXPECT_LE(largest, .03);
  EXPECT_LE(error, .05);
}

// A straight fault.
Eigen::Matrix2Xd segment(double x0, double y0, double x1, double y1) {
  Eigen::Matrix2Xd line(2, 2);
  line << x0, x1, y0, y1;
  return line;
}

TEST(FitWithFaults, LeavesNoWayBetweenLinesThatTouch) {
  const auto step = [](const Point<2>& p) { return waves<2>(p) + (p[0] > .5 ? 3 : 0); };
  std::vector<Eigen::Matrix2Xd> many;
  for (int k = 0; k < 30; ++k) many.push_back(segment(.5, -.1 + .04 * k, .5, -.06 + .04 * k));
  const std::vector<std::vector<Eigen::Matrix2Xd>> all = {
      {segment(.5, -.1, .5, .5), segment(.5, .5, .5, 1.1)},
      {segment(.5, -.1, .5 + 1e-7, .5 - 1e-7), segment(.5, 1.1, .5, .5)},
      {segment(.5, -.1, .5, .6), segment(.5, .4, .5, 1.1)},
      {segment(.5, -.1, .5, 1.1), segment(.5, .5, .7, .6)},
      {segment(.5, -.1, .5, 1.1), segment(.3, .4, .7, .6)},
      many};
  const Samples<2> data = sample<2>(random_points<2>(400, 1), step);
  for (const auto& faults : all)
    EXPECT_LE(rms_error<2>(*fit<2>(data, {.faults = faults}).components[0], step), .01) << faults.size();
}

TEST(FitWithFaults, OfTheSameLineTwiceAreThoseOfOne) {
  const Eigen::Matrix2Xd line = segment(.5, -.1, .5, .5);
  const Samples<2> data = sample<2>(random_points<2>(400, 1), waves<2>);
  const Points<2> x = random_points<2>(100, 2);
  const auto values = [&](const std::vector<Eigen::Matrix2Xd>& faults) {
    return fit<2>(data, {.faults = faults}).components[0]->evaluate(x).value;
  };
  EXPECT_LE((values({line}) - values({line, line})).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(FitWithFaults, WithoutSamplesNearAFaultIsAsWithoutIt) {
  Eigen::Matrix2Xd outside(2, 2);
  outside << 3, 4, 3, 4;
  const Samples<2> data = sample<2>(random_points<2>(1000, 1), franke);
  const Fit<2> result = fit<2>(data, {.faults = {outside}});
  EXPECT_LE(rms_error<2>(*result.components[0], franke), 1e-3);
}

TEST(FitWithFaults, MeasuresNoise) {
  Samples<2> data = sample<2>(random_points<2>(2000, 1), stepped);
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal(0, .1);
  for (double& value : data.values.reshaped()) value += normal(random);
  const Fit<2> result = fit<2>(data, {.faults = {through()}});
  EXPECT_LE(rms_error<2>(*result.components[0], stepped), .05);
  EXPECT_NEAR(result.report.noise[0], .1, .02);
  EXPECT_NEAR(std::sqrt((*result.variances[0])(Point<2>(.3, .5))), .1, .03);
}

TEST(FitWithFaults, NamesWhatIsWrong) {
  const Samples<2> data = sample<2>(random_points<2>(50, 1), franke);
  expect_refusal([&] { fit<2>(data, {.faults = {Eigen::Matrix2Xd::Zero(2, 1)}}); }, "two vertices");
  expect_refusal([&] { fit<2>(data, {.tolerance = .1, .faults = {through()}}); }, "cannot be combined");
  expect_refusal([&] { fit<3>(sample<3>(random_points<3>(50, 1), waves<3>), {.faults = {through()}}); }, "are for two");
}

// In corners and strips that samples leave, errors are a thousand times those in the middle of a patch.
TEST(FitWithFaults, DeviationsGrowWithTheDistanceToTheSamples) {
  const Samples<2> data = sample<2>(random_points<2>(400, 3), stepped);
  const Fit<2> found = fit<2>(data, {.faults = {through()}});
  const Points<2> x = random_points<2>(2000, 9);
  const Eigen::ArrayXd error =
      (found.components[0]->evaluate(x).value - sample<2>(x, stepped).values.col(0)).cwiseAbs();
  const Eigen::ArrayXd deviation = found.variances[0]->evaluate(x).value.cwiseSqrt();
  EXPECT_GE(static_cast<double>((error < 1.96 * deviation).count()), .95 * 2000);
  EXPECT_LE((error / deviation).maxCoeff(), 20);
  EXPECT_GT(deviation.maxCoeff(), 10 * deviation.minCoeff());
}

}  // namespace
}  // namespace csrbf::fit_with_faults_test
