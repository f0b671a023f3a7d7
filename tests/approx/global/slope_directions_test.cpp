#include "csrbf/approx/global/slope_directions.hpp"

#include "approx/approx_testing.hpp"

#include <random>

namespace csrbf::slope_directions_test {
namespace {

// Waves along a direction, slower ones across it, noise.
Samples<2> waves_along(double angle, double slow, double noise) {
  const Point<2> u(std::cos(angle), std::sin(angle)), v(-u.y(), u.x());
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  return sample<2>(random_points<2>(800, 2), [&](const Point<2>& p) {
    return std::sin(20 * u.dot(p)) + std::sin(slow * v.dot(p)) + noise * normal(random);
  });
}

TEST(SlopeDirections, AreAlongAndAcrossWaves) {
  for (const double noise : {0.0, 0.2})
    for (const double angle : {0.5, 0.785, 2.3}) {
      const auto axes = slope_directions(waves_along(angle, 1, noise));
      ASSERT_TRUE(axes) << angle;
      EXPECT_NEAR(std::abs(axes->col(1).dot(Point<2>(std::cos(angle), std::sin(angle)))), 1, 0.01) << angle << noise;
      EXPECT_TRUE((axes->transpose() * *axes).isIdentity(1e-12));
    }
}

TEST(SlopeDirections, AreNoneWhereThoseOfTheCoordinatesServe) {
  EXPECT_FALSE(slope_directions(waves_along(0.03, 1, 0)));
  EXPECT_FALSE(slope_directions(waves_along(0.7, 15, 0)));
  EXPECT_FALSE(slope_directions(sample<2>(random_points<2>(300, 1), franke)));
  EXPECT_FALSE(slope_directions(sample<1>(random_points<1>(300, 1), waves<1>)));
  EXPECT_FALSE(slope_directions(sample<2>(random_points<2>(6, 1), franke)));
}

}  // namespace
}  // namespace csrbf::slope_directions_test
