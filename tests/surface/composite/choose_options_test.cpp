#include "csrbf/surface/composite/choose_options.hpp"

#include "csrbf/core/parallel.hpp"
#include "surface/surface_testing.hpp"

#include <Eigen/Geometry>

namespace csrbf::choose_options_test {
namespace {

constexpr Index samples = 8000;

ChosenOptions choose_options(const OrientedPoints& cloud, const GivenOptions& given = {}) {
  return csrbf::choose_options(cloud, KdTree<3>(cloud.points), given);
}

OrientedPoints clean_torus() {
  return oriented(Torus().cloud(samples), Torus().area());
}

// Half a percent of the diagonal, about 0.9 spacings; normals turned by some 20 degrees.
constexpr double noise = 0.005 * 3.88;
OrientedPoints noisy_torus() {
  PointCloud cloud = with_noise(Torus().cloud(samples), noise);
  cloud.normals = with_noise({cloud.normals, Points<3>(3, 0), {}}, 0.25, 2).points.colwise().normalized();
  return oriented(cloud, Torus().area());
}

// Root mean square distance from the partition of unity to the torus.
double error_with(const OrientedPoints& cloud, const CompositeOptions& options) {
  const Patches patches = fit_composite(cloud, options).patches;
  const PointCloud probes = Torus().cloud(2000, 77);
  double sum = 0;
  for (Index i = 0; i < probes.size(); ++i) {
    PatchSums sums;
    patches.accumulate(probes.points.col(i), Derivatives::none, sums);
    const double f = sums.W[0][0] > 0 ? sums.S[0][0] / sums.W[0][0] : 1;
    sum += f * f;
  }
  return std::sqrt(sum / static_cast<double>(probes.size()));
}

void expect_same(const CompositeOptions& a, const CompositeOptions& b) {
  EXPECT_EQ(a.leaf_size, b.leaf_size);
  EXPECT_EQ(a.overlap, b.overlap);
  EXPECT_EQ(a.centers_per_patch, b.centers_per_patch);
  EXPECT_EQ(a.normal_weight, b.normal_weight);
  EXPECT_EQ(a.smoothing, b.smoothing);
  EXPECT_EQ(a.max_fit_points, b.max_fit_points);
  EXPECT_EQ(a.centers, b.centers);
  EXPECT_EQ(a.choose_leaves, b.choose_leaves);
}

TEST(ChooseOptions, TakesSmallPatchesForCleanSamples) {
  const ChosenOptions chosen = choose_options(clean_torus());
  EXPECT_LE(chosen.options.leaf_size, 14);
  EXPECT_FALSE(chosen.options.choose_leaves);
  EXPECT_GT(chosen.options.centers_per_patch, 0);
  const double spacing = clean_torus().spacing[0];
  EXPECT_GT(chosen.cross_validation_error, 0);
  EXPECT_LT(chosen.cross_validation_error, 0.01 * spacing);
  EXPECT_LE(error_with(clean_torus(), chosen.options), 1.2 * error_with(clean_torus(), {}));
}

// A patch may predict a stray sample to be anywhere: one of them says as much as one that is a patch away.
TEST(ChooseOptions, FollowsTheSurfaceAndNotFewStrays) {
  PointCloud cloud = Torus().cloud(samples);
  const double spacing = std::sqrt(Torus().area() / samples);
  for (Index i = 0; i < samples; i += 400) {
    cloud.points.col(i) += 2 * spacing * cloud.normals.col(i);
    cloud.normals.col(i) = cloud.normals.col(i).unitOrthogonal().eval();
  }
  const ChosenOptions clean = choose_options(clean_torus()), chosen = choose_options(oriented(cloud, Torus().area()));
  EXPECT_LE(chosen.options.leaf_size, clean.options.leaf_size);
  EXPECT_GT(chosen.options.centers_per_patch, 0);
  EXPECT_LT(chosen.cross_validation_error, 0.1 * spacing);
}

TEST(ChooseOptions, TakesLargePatchesForNoisySamples) {
  const ChosenOptions clean = choose_options(clean_torus()), noisy = choose_options(noisy_torus());
  EXPECT_GE(noisy.options.leaf_size, 4 * clean.options.leaf_size);
  const double error = error_with(noisy_torus(), noisy.options);
  EXPECT_LT(error, 0.35 * noise);
  // The mean of |x| is sqrt(2 / pi) standard deviations.
  EXPECT_NEAR(noisy.cross_validation_error, std::sqrt(2 / pi) * noise, 0.15 * noise);
  EXPECT_TRUE(noisy.options.choose_leaves);
}

TEST(ChooseOptions, TakesLargerPatchesForMoreNoise) {
  Index previous = 0;
  for (const double share : {0.0, 0.2, 1.0}) {
    const PointCloud clean = Torus().cloud(samples), cloud = share > 0 ? with_noise(clean, share * noise) : clean;
    const Index leaf_size = choose_options(oriented(cloud, Torus().area())).options.leaf_size;
    EXPECT_GE(leaf_size, previous) << share;
    previous = leaf_size;
  }
}

TEST(ChooseOptions, KeepsWhatIsGiven) {
  const ChosenOptions both = choose_options(noisy_torus(), {.smoothing = 0.25, .leaf_size = 17});
  EXPECT_EQ(both.options.smoothing, 0.25);
  EXPECT_EQ(both.options.leaf_size, 17);
  EXPECT_FALSE(both.options.choose_leaves);
  EXPECT_EQ(choose_options(clean_torus(), {.smoothing = 0.5, .leaf_size = {}}).options.smoothing, 0.5);
  EXPECT_EQ(choose_options(clean_torus(), {.smoothing = {}, .leaf_size = 100000}).options.leaf_size, 100000);
}

TEST(ChooseOptions, GivesTheDefaultsForTinyClouds) {
  for (const Index n : {0, 1, 4, 20, 60}) {
    const ChosenOptions chosen = choose_options(oriented(sphere_cloud(n), 4 * pi));
    expect_same(chosen.options, {});
    EXPECT_EQ(chosen.cross_validation_error, 0);
  }
  EXPECT_EQ(choose_options(oriented(sphere_cloud(20), 4 * pi), {.smoothing = 0.5, .leaf_size = 3}).options.leaf_size,
            3);
}

TEST(ChooseOptions, GivesTheSameForEveryNumberOfThreadsAndUnit) {
  const OrientedPoints cloud = noisy_torus();
  const ChosenOptions expected = choose_options(cloud);
  for (const int threads : {1, 3}) {
    set_thread_count(threads);
    const ChosenOptions chosen = choose_options(cloud);
    expect_same(chosen.options, expected.options);
    EXPECT_EQ(chosen.cross_validation_error, expected.cross_validation_error);
  }
  set_thread_count(0);
  const ChosenOptions small = choose_options({0x1p-20 * cloud.points, cloud.normals, 0x1p-20 * cloud.spacing});
  expect_same(small.options, expected.options);
  EXPECT_EQ(small.cross_validation_error, 0x1p-20 * expected.cross_validation_error);
  const Similarity map = rotation(2);
  expect_same(choose_options({map(cloud.points), map.R * cloud.normals, cloud.spacing}).options, expected.options);
}

}  // namespace
}  // namespace csrbf::choose_options_test
