#include "csrbf/approx/left_out/left_out_extremes.hpp"

#include "approx/approx_testing.hpp"
#include "csrbf/approx/fit.hpp"

namespace csrbf::left_out_extremes_test {
namespace {

// 40 samples with some noise.
template <class Function>
Samples<2> samples_of(const Function& function) {
  const Points<2> x = random_points<2>(40, 3), noise = random_points<2>(40, 4);
  Samples<2> samples = sample<2>(x, function);
  samples.values.col(0) += .05 * (noise.row(0).array() - .5).matrix().transpose();
  return samples;
}

double plane(const Point<2>& x) {
  return 3 * x[0] - x[1];
}

// Flat near the sides of the square, steep in the middle.
double saturated(const Point<2>& x) {
  return std::tanh(12 * (x[0] - .5)) + std::tanh(12 * (x[1] - .5));
}

AxisCovariance<2> smooth_covariance() {
  return {Kernel("matern-c2", 2), Point<2>(.5, .5), 1e-3, 1};
}

TEST(LeftOutExtremes, ATrendThatHoldsIsContinued) {
  EXPECT_EQ(best_for_extremes(samples_of(plane), smooth_covariance()), Extrapolation::trend);
  EXPECT_EQ(best_for_extremes(samples_of(saturated), smooth_covariance()), Extrapolation::constant);
}

// A few samples next to the box hardly tell, when there is noise.
TEST(LeftOutExtremes, SlopesAreSeenThroughNoise) {
  int trends = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> error(0, .5);
    Samples<2> samples = sample<2>(random_points<2>(60, seed), plane);
    for (double& value : samples.values.reshaped()) value += error(random);
    if (best_for_extremes(samples, {Kernel("gaussian", 2), Point<2>(2, 2), .1, 1}) == Extrapolation::trend) ++trends;
  }
  EXPECT_GE(trends, 30);
}

// On a lattice whole lines are outermost.
TEST(LeftOutExtremes, LatticesHaveThemToo) {
  Points<2> x(2, 64);
  for (Index i = 0; i < 64; ++i) x.col(i) = Point<2>(static_cast<double>(i % 8), static_cast<double>(i / 8)) / 7;
  EXPECT_EQ(best_for_extremes(sample<2>(x, plane), smooth_covariance()), Extrapolation::trend);
}

TEST(LeftOutExtremes, ManySamplesAreNotAsked) {
  EXPECT_EQ(best_for_extremes(sample<2>(random_points<2>(900, 3), plane), smooth_covariance()),
            Extrapolation::automatic);
}

TEST(LeftOutExtremes, FitsFollowThem) {
  Points<2> outside(2, 2);
  outside << 1.4, -.3, .5, 1.3;
  const Fit<2> continued = fit(samples_of(plane)), flat = fit(samples_of(saturated));
  const Eigen::VectorXd f = continued.components[0]->evaluate(outside).value;
  for (Index i = 0; i < 2; ++i) EXPECT_NEAR(f[i], plane(outside.col(i)), .3);
  EXPECT_LE(flat.components[0]->evaluate(outside).value.cwiseAbs().maxCoeff(), 2.3);
  const Fit<2> as_flat = fit(samples_of(saturated), {.extrapolation = Extrapolation::constant});
  for (Index i = 0; i < 2; ++i)
    EXPECT_EQ(flat.variances[0]->evaluate(outside).value[i], as_flat.variances[0]->evaluate(outside).value[i]);
  const Fit<2> told = fit(samples_of(plane), {.extrapolation = Extrapolation::constant});
  EXPECT_NEAR(told.components[0]->evaluate(outside).value[0], plane(Point<2>(1, .5)), .3);
}

}  // namespace
}  // namespace csrbf::left_out_extremes_test
