#include "csrbf/approx/left_out/left_out_planes.hpp"

#include "approx/approx_testing.hpp"
#include "csrbf/approx/fit.hpp"

namespace csrbf::left_out_planes_test {
namespace {

// A step along x between planes of a lattice, the same for all y.
double step(const Point<2>& p) {
  return std::tanh(20 * (p[0] - .52));
}

TEST(LeftOutPlanes, AreNoneWithoutALattice) {
  const AxisCovariance<2> covariance{Kernel("matern-c2", 2), Point<2>(.3, .3)};
  EXPECT_EQ(variance_by_planes(sample<2>(random_points<2>(200, 1), step), covariance).size(), 0);
}

// Lines along both axes: gaps as wide as those between them tell what planes of a lattice do.
TEST(LeftOutPlanes, HaveGapsBetweenLinesInTheirPlace) {
  Points<2> x = random_points<2>(400, 2);
  for (Index i = 0; i < x.cols(); ++i) x(i % 2, i) = (std::floor(6 * x(i % 2, i)) + .5) / 6;
  const AxisCovariance<2> covariance{Kernel("matern-c2", 2), Point<2>(.3, .3)};
  const Eigen::VectorXd variance = variance_by_planes(sample<2>(x, step), covariance);
  ASSERT_EQ(variance.size(), 1);
  EXPECT_GT(variance[0], .01);
}

TEST(LeftOutPlanes, TakeSystemsWithoutAFactor) {
  const AxisCovariance<2> smooth{Kernel("gaussian", 2), Point<2>(2, 100)};
  EXPECT_TRUE(variance_by_planes(sample<2>(unit_grid(14), step), smooth).allFinite());
}

TEST(LeftOutPlanes, SayHowWrongAFunctionIsBetweenThem) {
  const Samples<2> lattice = sample<2>(unit_grid(12), step);
  const AxisCovariance<2> covariance{Kernel("matern-c2", 2), Point<2>(.3, 100)};
  EXPECT_GT(variance_by_planes(lattice, covariance)[0], .01);
  const Fit<2> found = fit<2>(lattice);
  const Points<2> x = random_points<2>(500, 3);
  const Eigen::VectorXd value = found.components[0]->evaluate(x).value,
                        variance = found.variances[0]->evaluate(x).value;
  Index within = 0;
  for (Index i = 0; i < x.cols(); ++i)
    within += std::abs(value[i] - step(x.col(i))) < 2 * std::sqrt(variance[i]) ? 1 : 0;
  EXPECT_GT(within, 350);  // with the variance by leave-one-out a tenth of them
}

}  // namespace
}  // namespace csrbf::left_out_planes_test
