#include "csrbf/surface/composite/composite.hpp"
#include "csrbf/surface/reconstruct.hpp"

#include <gtest/gtest.h>

#include <random>

namespace csrbf::region_test {
namespace {

constexpr double spacing = 0.01, noise = 0.6 * spacing;
constexpr double wanted = 0;             // the region is y < 0, ...
constexpr double halo = 14 * spacing;    // ... beyond this distance from it samples are ever sparser
constexpr double width = 1, length = 1;  // of the region; outside there is ten times as much

double height(double x, double y) {
  return 0.15 * std::sin(3 * x) * std::cos(4 * y);
}

// Samples of a wavy sheet with noise, and their true normals.
PointCloud sheet() {
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0, noise);
  std::uniform_real_distribution<double> uniform(-0.5, 0.5);
  std::vector<Point<3>> points, normals;
  const auto add_rows = [&](double from, double to, double step) {
    for (double y = from; y < to; y += step)
      for (double x = 0; x < width; x += step) {
        const double px = x + step * uniform(random), py = y + step * uniform(random);
        normals.push_back(
            Point<3>(-0.45 * std::cos(3 * px) * std::cos(4 * py), 0.6 * std::sin(3 * px) * std::sin(4 * py), 1)
                .normalized());
        points.push_back(Point<3>(px, py, height(px, py)) + Point<3>(normal(random), normal(random), normal(random)));
      }
  };
  add_rows(-length, halo, spacing);
  for (double from = halo, step = 2 * spacing; from < 10 * length; from *= 2, step *= 2) add_rows(from, 2 * from, step);
  PointCloud cloud;
  cloud.points.resize(3, std::ssize(points));
  cloud.normals.resize(3, cloud.points.cols());
  for (Index i = 0; i < cloud.points.cols(); ++i) {
    cloud.points.col(i) = points[static_cast<std::size_t>(i)];
    cloud.normals.col(i) = normals[static_cast<std::size_t>(i)];
  }
  return cloud;
}

// Mean height of patches over the sheet, in the region.
double error(const Patches& patches) {
  double sum = 0;
  Index n = 0;
  for (double y = -0.9 * length; y < wanted; y += 0.05)
    for (double x = 0.1 * width; x < 0.9 * width; x += 0.05, ++n) {
      PatchSums sums;
      const Points<3> place = Point<3>(x, y, height(x, y));
      patches.accumulate(PointsRef<3>(place), Derivatives::none, sums);
      sum += std::abs(sums.S[0][0] / sums.W[0][0]);
    }
  return sum / static_cast<double>(n);
}

TEST(Region, SparseSamplesAroundDoNotSpoilLargePatches) {
  const PointCloud cloud = sheet();
  OrientedPoints points{cloud.points, cloud.normals, Eigen::VectorXd(cloud.size())};
  for (Index i = 0; i < cloud.size(); ++i) {
    const double beyond = cloud.points(1, i) / halo;
    points.spacing[i] = spacing * (beyond > 1 ? std::exp2(std::ceil(std::log2(beyond))) : 1);
  }
  CompositeOptions options;
  options.leaf_size = 200;
  options.normal_weight = 0.3;
  options.region = Box<3>{Point<3>(-1, -2, -1), Point<3>(2, wanted, 1)};
  const double with_them = error(fit_composite(points, options).patches);
  options.from_outside = false;
  const double without = error(fit_composite(points, options).patches);
  EXPECT_LT(without, 0.15 * noise);
  EXPECT_GT(with_them, 2 * without);
}

TEST(Region, NoiseLeavesTheSurfaceAsNearAsWithoutOne) {
  const PointCloud cloud = sheet();
  ReconstructOptions options;
  options.region = Box<3>{Point<3>(-1, -2, -1), Point<3>(2, wanted, 1)};
  const Reconstruction part = reconstruct(cloud, options);
  double sum = 0;
  for (const double distance : part.distance) sum += distance * bounding_box<3>(cloud.points).diagonal();
  EXPECT_LT(sum / static_cast<double>(part.distance.size()), noise);
}

}  // namespace
}  // namespace csrbf::region_test
