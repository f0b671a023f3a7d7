#include "csrbf/approx/unity/patch_samples.hpp"

#include "approx/approx_testing.hpp"

#include <Eigen/Eigenvalues>

namespace csrbf::patch_samples_test {
namespace {

constexpr double rounding = 1e-12;  // of ratios of size 1

template <int Dim>
bool is_lopsided(const Points<Dim>& points) {
  std::vector<std::pair<double, std::uint32_t>> chosen;
  for (Index i = 0; i < points.cols(); ++i)
    chosen.emplace_back(points.col(i).squaredNorm(), static_cast<std::uint32_t>(i));
  return lopsided<Dim>(points, chosen);
}

// Samples in a ball, stretched along the first axis.
template <int Dim>
Points<Dim> ball(double length) {
  Points<Dim> points = (2 * random_points<Dim>(20000, 1).array() - 1).matrix();
  Index kept = 0;
  for (Index i = 0; i < points.cols(); ++i)
    if (points.col(i).norm() < 1) points.col(kept++) = points.col(i);
  points.conservativeResize(Eigen::NoChange, std::min<Index>(kept, 500));
  points.row(0) *= length;
  return points;
}

TEST(PatchSamples, AreLopsidedWhereTheyHardlySpread) {
  EXPECT_FALSE(is_lopsided<1>(ball<1>(1)));
  EXPECT_FALSE(is_lopsided<2>(ball<2>(1)));
  EXPECT_FALSE(is_lopsided<3>(ball<3>(1)));
  EXPECT_FALSE(is_lopsided<6>(ball<6>(1)));
  EXPECT_TRUE(is_lopsided<2>(ball<2>(3)));
  EXPECT_TRUE(is_lopsided<3>(ball<3>(1e-3)));
  EXPECT_TRUE(is_lopsided<2>(ball<2>(0)));
  EXPECT_FALSE(is_lopsided<3>(1e-30 * ball<3>(1)));
  EXPECT_TRUE(is_lopsided<3>(1e30 * ball<3>(3)));
  EXPECT_TRUE(is_lopsided<1>((ball<1>(1).array() * .1 + .9).matrix()));  // all to one side
}

// Ratio of the lengths that the metric of the patch around (.5, 0) gives to steps across and along the first axis.
double stretch(const Points<2>& points, double anisotropy) {
  const Cover<2> cover(points, 4, 1.7);
  Cover<2>::Search search;
  const Eigen::Matrix2d metric = find_patch_samples<2>(cover, cover.find(Point<2>(.5, 0)), 12, anisotropy, search);
  EXPECT_LE((metric - metric.transpose()).cwiseAbs().maxCoeff(), rounding * metric.cwiseAbs().maxCoeff());
  return metric.col(1).norm() / metric.col(0).norm();
}

TEST(PatchSamples, AreFartherAcrossTheirTrackThanAlongIt) {
  Points<2> points = random_points<2>(200, 1);
  points.row(1) = 1e-3 * (points.row(1).array() - .5);
  EXPECT_EQ(stretch(points, 0), 1);
  const double half = stretch(points, .5), all = stretch(points, 1);
  EXPECT_GT(half, 2);
  EXPECT_NEAR(half * half, all, .1 * all);  // but for the tilt of the nearest samples
  points.row(1).setZero();
  EXPECT_NEAR(stretch(points, 1), 10, 1e-9);  // and no more, however narrow the track is
}

TEST(PatchSamples, HaveTheMetricOfTheirCovariance) {
  const Points<3> points = random_points<3>(2000, 1);
  const Cover<3> cover(points, 10, 1.5);
  Cover<3>::Search search;
  const Index cell = cover.find(Point<3>(.5, .5, .5));
  const Eigen::Matrix3d metric = find_patch_samples<3>(cover, cell, 40, 1, search);
  ASSERT_EQ(search.found.size(), 40U);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const auto& [d2, id] : search.found) {
    const Point<3> d = cover.points().col(id) - cover.cell(cell).center();
    EXPECT_NEAR(d.squaredNorm(), d2, rounding);
    covariance += d * d.transpose();
  }
  const Eigen::Matrix3d whitened = metric * covariance * metric.transpose();
  EXPECT_LE((whitened / whitened(0, 0) - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(), 1e-10);
}

TEST(PatchSamples, AtOnePointHaveTheEuclideanMetric) {
  const Cover<2> cover(Points<2>::Constant(2, 1, 3), 4, 1.7);
  Cover<2>::Search search;
  EXPECT_EQ((find_patch_samples<2>(cover, 0, 1, 1, search)), (Eigen::Matrix2d::Identity()));
}

}  // namespace
}  // namespace csrbf::patch_samples_test
