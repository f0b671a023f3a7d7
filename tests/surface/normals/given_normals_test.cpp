#include "csrbf/surface/normals/given_normals.hpp"

#include "csrbf/core/parallel.hpp"
#include "surface/oriented_shapes.hpp"

#include <gtest/gtest.h>

namespace csrbf::given_normals_test {
namespace {

// Adds Gaussian noise to normals of length 1.
Points<3> noisy(const Points<3>& normals, double deviation, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Points<3> result = normals;
  for (Index i = 0; i < result.cols(); ++i) {
    result.col(i) += deviation * Point<3>(normal(random), normal(random), normal(random));
    result.col(i).normalize();
  }
  return result;
}

// Mean angle between lines, in radians.
double mean_angle(const Points<3>& a, const Points<3>& b) {
  double sum = 0;
  for (Index i = 0; i < a.cols(); ++i) sum += std::acos(std::min(1.0, std::abs(a.col(i).dot(b.col(i)))));
  return sum / static_cast<double>(a.cols());
}

// Samples sorted along x: runs are slices.
struct Cloud {
  explicit Cloud(const Shape& shape) : points(shape.points), tree(points), near(make_neighbor_table(points, tree, 9)) {}

  NormalCorrection correct(Points<3>& normals) const { return correct_normals(points, tree, near, normals); }

  Points<3> points;
  KdTree<3> tree;
  NeighborTable near;
};

TEST(CorrectNormals, KeepsExactOnesToTheLastBit) {
  for (const Shape& shape : {random_sphere(1000, 1), random_torus(3000, 2), random_box({1, 0.5, 0.2}, 0.05, 3),
                             random_torus(8000, 4, 0.02)}) {
    Points<3> normals = shape.normals;
    const NormalCorrection done = Cloud(shape).correct(normals);
    EXPECT_EQ(done.corrected, 0);
    EXPECT_EQ(done.turned, 0);
    EXPECT_TRUE(normals == shape.normals);
  }
}

// Normals of neighbours then differ as much as errors would make them.
TEST(CorrectNormals, KeepsExactOnesOfFewSamples) {
  for (const unsigned seed : {1, 2, 3, 4}) {
    const Shape torus = random_torus(150, seed);
    Points<3> normals = torus.normals;
    EXPECT_EQ(Cloud(torus).correct(normals).corrected, 0) << seed;
  }
}

TEST(CorrectNormals, MeasuresAndReducesErrors) {
  const Shape torus = random_torus(8000, 5);
  for (const double deviation : {0.1, 0.2, 0.5}) {
    Points<3> normals = noisy(torus.normals, deviation, 6);
    const double before = mean_angle(normals, torus.normals);
    const NormalCorrection done = Cloud(torus).correct(normals);
    EXPECT_GT(done.corrected, 7900) << deviation;
    EXPECT_NEAR(done.error, deviation, 0.2 * deviation);  // unit vectors: errors of 0.5 become a little smaller
    EXPECT_LT(mean_angle(normals, torus.normals), 0.3 * before) << deviation;
    EXPECT_GT(outward_share(normals, torus.normals), 0.998) << deviation;
  }
}

TEST(CorrectNormals, CorrectsOnlyThePartWithErrors) {
  const Shape left = even_sphere(4000), right = even_sphere(4000, {3, 0, 0});
  const Shape both = join(left, right);
  Points<3> normals = both.normals;
  normals.rightCols(4000) = noisy(right.normals, 0.3, 7);
  const double before = mean_angle(normals.rightCols(4000), right.normals);
  const NormalCorrection done = Cloud(both).correct(normals);
  EXPECT_NEAR(static_cast<double>(done.corrected), 4000, 600);  // runs of 512
  EXPECT_TRUE(normals.leftCols(3400) == left.normals.leftCols(3400));
  EXPECT_LT(mean_angle(normals.rightCols(4000), right.normals), 0.3 * before);
}

TEST(CorrectNormals, PrefersGivenOnesWithSmallErrorsToThoseOfNoisyPositions) {
  const Shape torus = random_torus(8000, 8, 0.03);
  Points<3> normals = noisy(torus.normals, 0.06, 9);
  const Points<3> given = normals;
  Cloud(torus).correct(normals);
  EXPECT_LE(mean_angle(normals, torus.normals), 1.05 * mean_angle(given, torus.normals));
}

// Patches as wide as the noise asks for average independent errors of normals better than corrected ones.
TEST(CorrectNormals, LeavesThoseOfPositionsWithAsMuchNoise) {
  const double spacing = random_torus(8000, 8).spacing();
  for (const double noise : {0.3 * spacing, spacing}) {
    const Shape torus = random_torus(8000, 8, noise);
    for (const double deviation : {0.1, 0.2}) {
      Points<3> normals = noisy(torus.normals, deviation, 9);
      EXPECT_EQ(Cloud(torus).correct(normals).corrected, 0) << noise << ' ' << deviation;
    }
    // Those that are flipped are turned all the same.
    Points<3> flipped = noisy(torus.normals, 0.2, 9);
    for (Index i = 0; i < flipped.cols(); i += 10) flipped.col(i) *= -1;
    const NormalCorrection done = Cloud(torus).correct(flipped);
    EXPECT_TRUE(done.some_left);
    EXPECT_GT(done.turned, 650) << noise;  // of 800
    EXPECT_GT(outward_share(flipped, torus.normals), 0.98) << noise;
    Points<3> normals = noisy(torus.normals, 0.6, 9);
    EXPECT_GT(Cloud(torus).correct(normals).corrected, 7500) << noise;
  }
}

TEST(CorrectNormals, TurnsSingleOnesButNotTheOtherSideOfAPlate) {
  const Shape sphere = even_sphere(3000);
  Points<3> normals = sphere.normals;
  for (const Index i : {5, 700, 701, 2000}) normals.col(i) *= -1;
  EXPECT_EQ(Cloud(sphere).correct(normals).turned, 4);
  EXPECT_TRUE(normals == sphere.normals);

  const Shape plate = random_box({1, 1, 0.02}, 0.05, 10);  // thinner than the distance of its samples
  normals = plate.normals;
  EXPECT_EQ(Cloud(plate).correct(normals).corrected, 0);
  EXPECT_GT(outward_share(normals, plate.normals), 0.99);
}

TEST(CorrectNormals, DoesNotDependOnTheThreads) {
  const Shape torus = random_torus(5000, 11);
  const Points<3> given = noisy(torus.normals, 0.3, 12);
  const Cloud cloud(torus);
  Points<3> first = given, second = given;
  set_thread_count(1);
  cloud.correct(first);
  set_thread_count(4);
  cloud.correct(second);
  set_thread_count(0);
  EXPECT_TRUE(first == second);
}

}  // namespace
}  // namespace csrbf::given_normals_test
