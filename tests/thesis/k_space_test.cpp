#include "thesis/k_space.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace csrbf::thesis::k_space_test {
namespace {

using std::numbers::pi;

TEST(KSpace, TheTransformAtZeroIsTheAreaTimesTheValue) {
  const Ellipse e{2, .3, .5, .1, -.2, .4};
  EXPECT_NEAR(std::abs(e.transform({0, 0}) - 2 * pi * .3 * .5), 0, 1e-12);
}

TEST(KSpace, TheTransformIsTheIntegralOfItsDefinition) {
  const Ellipse e{1, .3, .5, .1, -.2, .4};
  const Point<2> k(.7, -.4);
  constexpr Index n = 1000;
  std::complex<double> sum = 0;
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j) {
      const Point<2> p(2 * (static_cast<double>(i) + .5) / n - 1, 2 * (static_cast<double>(j) + .5) / n - 1);
      if (e.level(p) < 1) sum += std::polar(4.0 / (n * n), -2 * pi * k.dot(p));
    }
  EXPECT_NEAR(std::abs(sum - e.transform(k)), 0, 2e-4);  // the border of the ellipse: about h^1.5
}

// A single Gaussian in k-space is one in the image.
TEST(KSpace, TheImageIsTheInverseTransform) {
  constexpr Index n = 32;
  // At the border of the grid the transform is still exp(-6.4 pi) = 2e-9.
  constexpr double beyond_the_grid = 1e-8;
  Eigen::MatrixXcd grid(n, n);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j)
      grid(i, j) = std::exp(-pi * 0.1 * static_cast<double>((i - 16) * (i - 16) + (j - 16) * (j - 16)) / 4);
  const Eigen::MatrixXcd image = image_of(grid);
  for (Index i = 8; i < 24; ++i) {
    const double x = 2.0 * static_cast<double>(i - 16) / n;
    EXPECT_NEAR(std::abs(image(i, 16) - 10 * std::exp(-10 * pi * x * x)), 0, beyond_the_grid);
  }
}

TEST(KSpace, TrajectoriesCoverTheDiskWithoutLargeGaps) {
  for (const Trajectory kind : {Trajectory::radial, Trajectory::spiral}) {
    const Points<2> places = trajectory(kind, 32);
    EXPECT_LE(places.colwise().norm().maxCoeff(), 16);
    for (double angle = 0; angle < 2 * pi; angle += .1)
      for (double r = 0; r < 15; r += .5) {
        const Point<2> p(r * std::cos(angle), r * std::sin(angle));
        EXPECT_LT((places.colwise() - p).colwise().norm().minCoeff(), 1);
      }
  }
}

TEST(KSpace, TheFitIsFiveTimesBetterThanGridding) {
  for (const Trajectory kind : {Trajectory::radial, Trajectory::spiral}) {
    const KSpaceResult r = reconstruct_k_space(kind, 64);
    EXPECT_LT(5 * r.fit_error, r.nearest_error);
    EXPECT_LT(5 * r.fit_error, r.gridding_error);
  }
}

}  // namespace
}  // namespace csrbf::thesis::k_space_test
