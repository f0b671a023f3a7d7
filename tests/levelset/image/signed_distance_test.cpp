#include "csrbf/levelset/image/signed_distance.hpp"

#include "levelset/levelset_testing.hpp"

#include <gtest/gtest.h>

namespace csrbf::signed_distance_test {
namespace {

constexpr double rounding = 1e-5;  // of float

TEST(SignedDistance, IsTheDistanceFromAPlaneMidwayBetweenVoxels) {
  Grid grid = square_grid(9);
  grid.spacing = Point<3>(2, 3, 1);
  std::vector<unsigned char> labels(81);
  for (Index y = 0; y < 9; ++y)
    for (Index x = 0; x < 9; ++x) labels[grid.index(x, y)] = x < 4 ? 1 : 0;
  const std::vector<float> d = signed_distance(grid, labels.data());
  for (Index y = 0; y < 9; ++y)
    for (Index x = 0; x < 9; ++x) EXPECT_NEAR(d[grid.index(x, y)], 2 * (3.5 - static_cast<double>(x)), rounding);
}

TEST(SignedDistance, AgreesWithBruteForceOnAnisotropicVoxels) {
  Grid grid;
  grid.size = {9, 7, 6};
  grid.spacing = Point<3>(1, 1.7, .6);
  std::mt19937 random(3);
  std::vector<unsigned char> labels;
  for (Index i = 0; i < grid.voxels(); ++i) labels.push_back(random() % 5 == 0 ? 1 : 0);
  const std::vector<float> d = signed_distance(grid, labels.data());
  const Points<3> p = grid.centers<3>();
  for (Index i = 0; i < grid.voxels(); ++i) {
    double nearest = std::numeric_limits<double>::infinity();
    for (Index j = 0; j < grid.voxels(); ++j)
      if (labels[j] != labels[i]) nearest = std::min(nearest, (p.col(i) - p.col(j)).norm());
    const double sign = labels[i] != 0 ? 1 : -1;
    EXPECT_NEAR(d[i], sign * (nearest - .3), rounding);
  }
}

TEST(SignedDistance, ChangesSignWithTheLabels) {
  const Grid grid = square_grid(40);
  std::vector<unsigned char> labels = ball_labels(grid, Point<3>(20, 17, 0), 9);
  const std::vector<float> d = signed_distance(grid, labels.data());
  for (unsigned char& label : labels) label = label == 0 ? 1 : 0;
  const std::vector<float> opposite = signed_distance(grid, labels.data());
  for (std::size_t i = 0; i < d.size(); ++i) EXPECT_EQ(d[i], -opposite[i]);
}

TEST(SignedDistance, IsTheDiagonalWhereThereIsOneLabel) {
  const Grid grid = square_grid(8);
  const double diagonal = 8 * std::sqrt(2.0) - .5;
  for (const float d : signed_distance(grid, std::vector<unsigned char>(64, 1).data()))
    EXPECT_NEAR(d, diagonal, rounding);
  for (const float d : signed_distance(grid, std::vector<unsigned char>(64, 0).data()))
    EXPECT_NEAR(d, -diagonal, rounding);
}

}  // namespace
}  // namespace csrbf::signed_distance_test
