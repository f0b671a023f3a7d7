#include "csrbf/approx/global/posterior_points.hpp"

#include <gtest/gtest.h>
#include <Eigen/LU>

#include <cmath>

namespace csrbf::posterior_points_test {
namespace {

TEST(PosteriorPoints, HaveTheMeanAndTheCovarianceOfANormalLaw) {
  Eigen::Matrix2d covariance;
  covariance << .5, .2, .2, .3;
  const Eigen::Vector2d mode(1, -2), far(100, 100);
  const PosteriorPoints found = posterior_points(mode, covariance.inverse(), -far, far);
  ASSERT_EQ(found.points.size(), 5U);
  Eigen::VectorXd weights(5);
  for (Index k = 0; k < 5; ++k) {
    const Eigen::VectorXd d = found.points[static_cast<std::size_t>(k)] - mode;
    weights[k] = std::exp(found.log_volumes[k] - .5 * d.dot(covariance.inverse() * d));
  }
  weights /= weights.sum();
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (Index k = 0; k < 5; ++k) {
    const Eigen::VectorXd d = found.points[static_cast<std::size_t>(k)] - mode;
    mean += weights[k] * d;
    spread += weights[k] * d * d.transpose();
  }
  EXPECT_LE(mean.norm(), 1e-12);
  EXPECT_TRUE(spread.isApprox(covariance, 1e-9));
}

TEST(PosteriorPoints, StayWithinBoundsWhereNothingIsKnown) {
  const Eigen::Vector2d mode(0, 0), bound(1, 1);
  for (const Eigen::VectorXd& x : posterior_points(mode, Eigen::Matrix2d::Zero(), -bound, bound).points)
    EXPECT_LE(x.cwiseAbs().maxCoeff(), 1);
}

TEST(EvenShares, GiveLikelyOnesMoreAndUnlikelyOnesNothing) {
  const std::vector<Share> shares =
      even_shares(Eigen::Vector4d(std::log(.02), std::log(.5), std::log(.28), std::log(.2)), 4);
  ASSERT_EQ(shares.size(), 3U);
  EXPECT_EQ(shares[0].number, 1U);
  EXPECT_EQ(shares[0].weight, .5);
  EXPECT_EQ(shares[1].weight, .25);
  EXPECT_EQ(shares[2].weight, .25);
}

}  // namespace
}  // namespace csrbf::posterior_points_test
