#include "csrbf/approx/levels/least_squares.hpp"

#include "approx/approx_testing.hpp"
#include "csrbf/approx/levels/level_builder.hpp"
#include "csrbf/approx/levels/level_sum.hpp"
#include "csrbf/kernels/kernel.hpp"

namespace csrbf::least_squares_test {
namespace {

TEST(LeastSquares, IsTheInterpolantOfAFunctionOfItsOwnSpace) {
  const Points<2> centers = random_points<2>(60, 1);
  const auto truth = make_expansion<2>(Kernel("wendland-c2", 2), centers, Eigen::VectorXd::Constant(1, .8),
                                       random_points<1>(60, 2).transpose().array() - .5);
  const Samples<2> data = sample<2>(random_points<2>(500, 3), [&](const Point<2>& p) { return (*truth)(p); });
  LevelBuilder<2> builder(data, "test", {});
  builder.add(Kernel("wendland-c2", 2), centers, Eigen::VectorXd::Constant(1, .8), LevelSolve::ridge, 1e-14);
  // The mean is taken off first; it is not in the space, but nearly.
  EXPECT_LT(builder.finish().last().rmse, 1e-2);
}

TEST(LeastSquares, AgreesForBothPenaltiesOnSmoothData) {
  const Samples<2> data = sample<2>(random_points<2>(2000, 1), franke);
  for (const LevelSolve penalty : {LevelSolve::ridge, LevelSolve::native}) {
    const auto fit = least_squares<2>(data, {.centers = 400, .support = 8, .penalty = penalty});
    EXPECT_LT(rms_error<2>(*fit.fields[0], franke), 2e-3);
  }
}

TEST(LeastSquares, ChoosesTheSmoothingOfNoisyData) {
  Samples<2> data = sample<2>(random_points<2>(3000, 1), franke);
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0, .1);
  for (double& value : data.values.reshaped()) value += noise(random);
  const auto error = [&](std::optional<double> lambda0) {
    const auto fit = least_squares<2>(data, {.centers = 750, .penalty = LevelSolve::native, .lambda0 = lambda0});
    return rms_error<2>(*fit.fields[0], franke);
  };
  double best = std::numeric_limits<double>::infinity();
  for (double exponent = -8; exponent <= 1; ++exponent) best = std::min(best, error(std::pow(10, exponent)));
  EXPECT_LT(error({}), 1.1 * best);
}

TEST(LeastSquares, WeighsSamples) {
  Samples<1> data{random_points<1>(200, 1), Eigen::MatrixXd::Zero(200, 1), Eigen::VectorXd::Ones(200)};
  data.values.bottomRows(100).setConstant(100);
  data.weights.tail(100).setZero();
  const auto fit = least_squares<1>(data, {.centers = 20});
  EXPECT_LT(fit.fields[0]->evaluate(data.points).value.cwiseAbs().maxCoeff(), 1e-12);
}

TEST(LeastSquares, RefusesBadOptions) {
  const Samples<2> data = sample<2>(random_points<2>(10, 1), franke);
  EXPECT_THROW(least_squares<2>(data, {.centers = -1}), InvalidInput);
  EXPECT_THROW(least_squares<2>(data, {.support = -1}), InvalidInput);
  EXPECT_THROW(least_squares<2>(data, {.penalty = LevelSolve::interpolation}), InvalidInput);
  EXPECT_THROW(least_squares<2>(data, Points<2>(2, 0)), InvalidInput);
}

}  // namespace
}  // namespace csrbf::least_squares_test
