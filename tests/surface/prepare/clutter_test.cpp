#include "csrbf/surface/prepare/clutter.hpp"

#include "surface/oriented_shapes.hpp"

#include <gtest/gtest.h>

namespace csrbf::clutter_test {
namespace {

// The samples of a shape, then points anywhere in its bounding box with random normals.
Shape cluttered(const Shape& shape, Index count, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform;
  std::normal_distribution<double> normal;
  const Box<3> box = bounding_box<3>(shape.points);
  Shape clutter{Points<3>(3, count), Points<3>(3, count), 0};
  for (Index i = 0; i < count; ++i) {
    const Point<3> u(uniform(random), uniform(random), uniform(random));
    clutter.points.col(i) = box.lo + u.cwiseProduct(box.hi - box.lo);
    clutter.normals.col(i) = Point<3>(normal(random), normal(random), normal(random)).normalized();
  }
  Shape both = join(shape, clutter);
  both.area = shape.area;
  return both;
}

double density_of(const Points<3>& points) {
  const KdTree<3> tree(points);
  return clutter_density(points, tree, make_neighbor_table(points, tree, 9));
}

double torus_distance(const Point<3>& p) {
  return std::abs(std::hypot(std::hypot(p[0], p[1]) - torus_major, p[2]) - torus_minor);
}

TEST(Clutter, IsMeasured) {
  const Shape input = cluttered(random_torus(10'000, 1), 2000, 2);
  const Box<3> box = bounding_box<3>(input.points);
  const double expected = 2000 / (box.hi - box.lo).prod();
  EXPECT_NEAR(density_of(input.points), expected, 0.3 * expected);
}

// Walls four spacings apart, so that every outlier is near one.
TEST(Clutter, IsMeasuredAmongWalls) {
  Shape walls = random_box({0.5, 0.5, 0.5}, 0.025, 15);
  for (int k = 0; k < 4; ++k) {
    Shape slot = random_box({0.4, 0.4, 0.05}, 0.025, 16 + k);
    slot.points.row(2).array() += 0.2 * (k - 1.5);
    walls = join(walls, slot);
  }
  const Index count = walls.size() / 5;
  const Shape input = cluttered(walls, count, 30);
  const Box<3> box = bounding_box<3>(input.points);
  const double expected = static_cast<double>(count) / (box.hi - box.lo).prod();
  EXPECT_NEAR(density_of(input.points), expected, 0.3 * expected);
  EXPECT_EQ(density_of(walls.points), 0);
  std::normal_distribution<double> noise(0, 0.025);
  std::mt19937_64 random(31);
  for (double& x : walls.points.reshaped()) x += noise(random);
  EXPECT_EQ(density_of(walls.points), 0);
  const std::vector<Index> kept = all_but_clutter(input.points, Points<3>(3, 0), density_of(input.points));
  const auto good = std::count_if(kept.begin(), kept.end(), [&](Index i) { return i < walls.size(); });
  EXPECT_GT(static_cast<double>(good), 0.94 * static_cast<double>(walls.size()));
}

TEST(Clutter, IsLeftOutAndHardlyAnySample) {
  constexpr Index samples = 10'000;
  for (const bool with_normals : {false, true})
    for (const Index count : {500, 2500}) {
      const Shape input = cluttered(random_torus(samples, 3), count, 4);
      const std::vector<Index> kept =
          all_but_clutter(input.points, with_normals ? input.normals : Points<3>(3, 0), density_of(input.points));
      EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end()));
      const double spacing = input.area > 0 ? std::sqrt(input.area / samples) : 0;
      Index good = 0, far = 0;
      for (const Index i : kept) {
        good += i < samples ? 1 : 0;
        far += i >= samples && torus_distance(input.points.col(i)) > 2 * spacing ? 1 : 0;
      }
      EXPECT_GT(good, 0.995 * samples);
      EXPECT_LT(far, 0.03 * static_cast<double>(count));
    }
}

TEST(Clutter, IsNotFoundInCleanNoisyOrUnevenClouds) {
  EXPECT_EQ(density_of(random_sphere(2000, 5).points), 0);
  EXPECT_EQ(density_of(random_torus(10'000, 6, 0.02).points), 0);
  EXPECT_EQ(density_of(random_box({1, 1, 0.05}, 0.02, 7).points), 0);
  // One in fifty samples on one side.
  const Shape dense = random_sphere(20'000, 8);
  std::vector<Index> kept;
  for (Index i = 0; i < dense.size(); ++i)
    if (dense.points(0, i) < 0 || i % 50 == 0) kept.push_back(i);
  EXPECT_EQ(density_of(dense.points(Eigen::all, kept)), 0);
  // Sparse samples everywhere among dense ones.
  const Shape uneven = join(random_sphere(20'000, 9, {3, 0, 0}, 0.2), random_sphere(1000, 10));
  EXPECT_EQ(density_of(uneven.points), 0);
}

TEST(Clutter, LeavesSparsePartsOfTheSurface) {
  const Shape dense = random_sphere(20'000, 11);
  std::vector<Index> some;
  for (Index i = 0; i < dense.size(); ++i)
    if (dense.points(0, i) < 0 || i % 8 == 0) some.push_back(i);
  const Shape shape{dense.points(Eigen::all, some), dense.normals(Eigen::all, some), dense.area};
  const Shape input = cluttered(shape, 700, 12);
  const std::vector<Index> kept = all_but_clutter(input.points, Points<3>(3, 0), density_of(input.points));
  const auto good = std::count_if(kept.begin(), kept.end(), [&](Index i) { return i < shape.size(); });
  EXPECT_GT(static_cast<double>(good), 0.98 * static_cast<double>(shape.size()));
}

// Where hardly any point would be left, all are.
TEST(Clutter, IsLeftInWhereThereIsNothingElse) {
  const Shape input = cluttered(random_sphere(20, 17), 300, 18);
  const Box<3> box = bounding_box<3>(input.points);
  for (const double times : {1.0, 10.0, 100.0}) {
    const double density = times * static_cast<double>(input.size()) / (box.hi - box.lo).prod();
    const std::vector<Index> kept = all_but_clutter(input.points, Points<3>(3, 0), density);
    EXPECT_EQ(std::ssize(kept), input.size()) << times;
    EXPECT_EQ(std::adjacent_find(kept.begin(), kept.end(), std::greater_equal<>()), kept.end()) << times;
  }
}

// Neighbours on the other side of the wall, or around its edge, do not make samples clutter.
TEST(Clutter, LeavesThinPlatesAndTheirEdges) {
  for (const double thickness : {0.5, 1.0, 2.0}) {
    const Shape plate = random_bowl(10'000, thickness, 13);
    const Shape input = cluttered(plate, 2000, 14);
    const std::vector<Index> kept = all_but_clutter(input.points, Points<3>(3, 0), density_of(input.points));
    const auto good = std::count_if(kept.begin(), kept.end(), [&](Index i) { return i < plate.size(); });
    EXPECT_GT(static_cast<double>(good), 0.98 * static_cast<double>(plate.size())) << thickness;
  }
}

}  // namespace
}  // namespace csrbf::clutter_test
