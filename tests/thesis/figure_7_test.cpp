#include "thesis/figure_7_1.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

namespace csrbf::thesis::figure_7_test {
namespace {

double share(const std::vector<std::uint8_t>& labels) {
  return static_cast<double>(std::count(labels.begin(), labels.end(), 1)) / static_cast<double>(labels.size());
}

double variance(const std::vector<float>& values) {
  const Eigen::VectorXd v =
      Eigen::Map<const Eigen::VectorXf>(values.data(), static_cast<Index>(values.size())).cast<double>();
  return (v.array() - v.mean()).square().mean();
}

TEST(Phantoms, HoldTheAreasOfTheirShapes) {
  // Integrals of r^2 / 2 over the angle, less the holes.
  const double body = std::numbers::pi * (95 * 95 + 0.5 * (18 * 18 + 8 * 8) - 24 * 24 - 20 * 20);
  // Pixels of 4 x 4 parts are in when half of the parts are: up to an eighth of a pixel along the border.
  EXPECT_NEAR(share(holed_shape().truth) * 311 * 311, body, 940.0 / 8);
  const double rays = std::numbers::pi * (120 * 120 + 0.5 * 70 * 70);
  EXPECT_NEAR(share(star().truth) * 446 * 446, rays, 3300.0 / 8);
}

TEST(Phantoms, NoiseHasTheVarianceThatItsDecibelsSay) {
  Phantom phantom = star();
  const double signal = variance(phantom.image.values);
  add_white_noise(phantom.image, 10, 3);
  EXPECT_NEAR(variance(phantom.image.values), 1.1 * signal, 0.01 * signal);
}

TEST(Phantoms, TrabeculaeHaveTheDerivativesOfTheirValues) {
  const Trabeculae field(40);
  const Point<3> p(7.3, 11.9, 23.1);
  constexpr double h = 1e-4, close = 1e-6;
  const Jet<3> jet = field.evaluate(p, Derivatives::hessian);
  for (int a = 0; a < 3; ++a) {
    const Point<3> step = h * Point<3>::Unit(a);
    EXPECT_NEAR(jet.gradient(a, 0), (field(p + step) - field(p - step)) / (2 * h), close);
    const Eigen::Vector3d change = field.evaluate(p + step, Derivatives::gradient).gradient.col(0) -
                                   field.evaluate(p - step, Derivatives::gradient).gradient.col(0);
    for (int b = 0; b < 3; ++b) EXPECT_NEAR(jet.hessian_matrix(0)(a, b), change[b] / (2 * h), close);
  }
}

TEST(Figure_7_1, AContourAroundTheObjectSplitsIntoItsBorders) {
  const SegmentedImage start = active_contour(0), last = active_contour(150);
  EXPECT_LT(start.dice, 0.7);
  EXPECT_GT(last.dice, 0.99);
}

TEST(LevelSets, DrawPictures) {
  const Phantom image = speckled_wall(1);
  const auto disc = disc_field(image.image.grid, Point<2>(20, 84), 9);
  for (const RgbImage& picture : {drawn(image.image, {disc.get()}), relief(*disc, 200)}) {
    EXPECT_GT(picture.width, 0);
    EXPECT_NE(*std::min_element(picture.pixels.begin(), picture.pixels.end()),
              *std::max_element(picture.pixels.begin(), picture.pixels.end()));
  }
}

}  // namespace
}  // namespace csrbf::thesis::figure_7_test
