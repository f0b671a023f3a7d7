#include "csrbf/spatial/distance_transform.hpp"

#include "core/error_testing.hpp"
#include "csrbf/core/parallel.hpp"

#include <gtest/gtest.h>

#include <random>

namespace csrbf::distance_transform_test {
namespace {

using Marks = std::vector<std::uint8_t>;
using Size = std::array<Index, 3>;

constexpr float float_rounding = 1e-6F;

Marks random_marks(const Size& size, double share, unsigned seed) {
  std::mt19937 random(seed);
  std::bernoulli_distribution marked(share);
  Marks marks(static_cast<std::size_t>(size[0] * size[1] * size[2]));
  for (std::uint8_t& mark : marks) mark = marked(random) ? 1 : 0;
  return marks;
}

Point<3> position(const Size& size, const Point<3>& spacing, Index i) {
  const Point<3> voxel(static_cast<double>(i % size[0]), static_cast<double>(i / size[0] % size[1]),
                       static_cast<double>(i / (size[0] * size[1])));
  return spacing.cwiseProduct(voxel);
}

TEST(DistanceTransform, OfOneVoxelIsTheDistanceToIt) {
  const Size size{7, 1, 5};
  const Point<3> spacing(0.5, 9, 2);
  Marks marks(35, 0);
  marks[3 + 7 * 1] = 1;
  const std::vector<float> distance = distance_transform(size, spacing, marks);
  for (Index z = 0; z < 5; ++z)
    for (Index x = 0; x < 7; ++x) {
      const double expected = std::hypot(0.5 * static_cast<double>(x - 3), 2.0 * static_cast<double>(z - 1));
      EXPECT_NEAR(distance[x + 7 * z], expected, float_rounding * 5);
    }
}

TEST(DistanceTransform, IsInfiniteWhenNothingIsMarked) {
  for (const float d : distance_transform({4, 3, 2}, Point<3>::Ones(), Marks(24, 0)))
    EXPECT_EQ(d, std::numeric_limits<float>::infinity());
}

TEST(DistanceTransform, AgreesWithTheNearestOfAllMarkedVoxels) {
  const std::vector<std::pair<Size, Point<3>>> lattices{{{40, 1, 1}, Point<3>(0.3, 1, 1)},
                                                        {{37, 21, 1}, Point<3>(1, 1, 1)},
                                                        {{21, 37, 1}, Point<3>(1, 3.7, 1)},
                                                        {{13, 11, 17}, Point<3>(0.9, 0.9, 5)},
                                                        {{20, 3, 9}, Point<3>(2, 0.1, 0.7)}};
  unsigned seed = 0;
  for (const auto& [size, spacing] : lattices)
    for (const double share : {0.003, 0.05, 0.6}) {
      Marks marks = random_marks(size, share, ++seed);
      marks[marks.size() / 3] = 1;
      const std::vector<float> distance = distance_transform(size, spacing, marks);
      for (std::size_t i = 0; i < marks.size(); ++i) {
        double nearest = std::numeric_limits<double>::infinity();
        for (std::size_t j = 0; j < marks.size(); ++j)
          if (marks[j] != 0)
            nearest = std::min(nearest, (position(size, spacing, static_cast<Index>(i)) -
                                         position(size, spacing, static_cast<Index>(j)))
                                            .norm());
        ASSERT_NEAR(distance[i], nearest, static_cast<double>(float_rounding) * (1 + nearest)) << seed << ' ' << i;
      }
    }
}

TEST(DistanceTransform, IsTheSameForEveryNumberOfThreads) {
  const Size size{50, 40, 30};
  const Marks marks = random_marks(size, 0.001, 5);
  const int before = thread_count();
  set_thread_count(1);
  const std::vector<float> one = distance_transform(size, Point<3>(1, 2, 3), marks);
  set_thread_count(3);
  EXPECT_EQ(one, distance_transform(size, Point<3>(1, 2, 3), marks));
  set_thread_count(before);
}

TEST(DistanceTransform, RefusesSizesThatDoNotMatchAndSpacingsThatAreNone) {
  const auto message = [](const Size& size, const Point<3>& spacing) {
    return invalid_input_message([&] { distance_transform(size, spacing, Marks(6, 1)); });
  };
  EXPECT_EQ(message({2, 3, 2}, Point<3>::Ones()),
            "distance_transform: entries of marked = 6: there must be one for each voxel, and at least one");
  EXPECT_EQ(message({2, 3, 1}, Point<3>(1, 0, 1)), "distance_transform: spacing = 1 0 1: must be positive and finite");
  EXPECT_NE(message({2, 3, 1}, Point<3>(1, NAN, 1)), "");
}

}  // namespace
}  // namespace csrbf::distance_transform_test
