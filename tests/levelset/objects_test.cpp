#include "csrbf/levelset/objects.hpp"

#include "csrbf/core/error.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace csrbf::objects_test {
namespace {

struct Ball {
  double x, y, z, radius;
};

// 1 within the balls; the values are 10 there and 2 elsewhere.
struct Picture {
  Volume<float> image;
  std::vector<std::uint8_t> labels;

  Picture(std::array<Index, 3> size, const std::vector<Ball>& balls, Point<3> spacing = Point<3>::Ones()) {
    VolumeLayout layout;
    layout.grid.size = size;
    layout.grid.axes = size[2] > 1 ? 3 : 2;
    layout.grid.spacing = spacing;
    image = Volume<float>(layout, 2);
    labels.assign(image.values.size(), 0);
    for (Index z = 0; z < size[2]; ++z)
      for (Index y = 0; y < size[1]; ++y)
        for (Index x = 0; x < size[0]; ++x)
          for (const Ball& b : balls) {
            const Point<3> off =
                Point<3>(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)).cwiseProduct(spacing) -
                Point<3>(b.x, b.y, b.z);
            if (off.norm() > b.radius) continue;
            labels[layout.grid.index(x, y, z)] = 1;
            image.values[layout.grid.index(x, y, z)] = 10;
          }
  }
};

TEST(Objects, SplitsTouchingDiscsAndLeavesOvalsWhole) {
  const std::vector<Ball> touching{{30, 30, 0, 12}, {50, 33, 0, 11}, {42, 50, 0, 10}}, far{{80, 80, 0, 9}};
  std::vector<Ball> all = touching;
  all.push_back(far[0]);
  for (double x = 10; x < 40; x += 0.5) all.push_back({x, 85, 0, 8});  // a sausage
  const Picture picture({100, 100, 1}, all);
  const Objects found = find_objects(picture.image, picture.labels);
  EXPECT_EQ(found.table.size(), 5U);
  EXPECT_EQ(find_objects(picture.image, picture.labels, {.split = false}).table.size(), 3U);
  for (const Ball& b : touching)
    for (const Ball& other : touching) {
      const auto label = [&](const Ball& at) {
        return found.labels[picture.image.grid.index(std::lround(at.x), std::lround(at.y))];
      };
      EXPECT_EQ(label(b) == label(other), &b == &other);
    }
  for (std::size_t i = 0; i < found.labels.size(); ++i) EXPECT_EQ(found.labels[i] != 0, picture.labels[i] != 0);
}

// Along a part of a circle.
std::vector<Ball> arc(double x, double y, double z, double radius, double half_angle, double width) {
  std::vector<Ball> balls;
  for (double angle = -half_angle; angle <= half_angle; angle += 0.02)
    balls.push_back({x + radius * std::sin(angle), y - radius * std::cos(angle), z, width});
  return balls;
}

TEST(Objects, ThatAreBentRodsAreWhole) {
  const Picture rod({80, 60, 1}, arc(40.3, 40.2, 0, 28, 1, 5));
  EXPECT_EQ(find_objects(rod.image, rod.labels).table.size(), 1U);
  std::vector<Ball> two = arc(30.3, 40.2, 0, 22, 1.1, 5);
  for (const Ball& b : arc(52, 20, 0, 20, 1, 5)) two.push_back({b.x, 2 * 20 - b.y, 0, b.radius});  // the other way
  const Picture rods({90, 60, 1}, two);
  EXPECT_EQ(find_objects(rods.image, rods.labels, {.split = false}).table.size(), 1U);
  EXPECT_EQ(find_objects(rods.image, rods.labels).table.size(), 2U);
  const Picture deep({80, 60, 8}, arc(40.3, 40.2, 8, 28, 1, 5), {1, 1, 2});
  EXPECT_EQ(find_objects(deep.image, deep.labels).table.size(), 1U);
}

// Discs with a hollow of half their radius.
Picture rings(const std::vector<Ball>& discs) {
  Picture result({90, 60, 1}, discs);
  for (Index y = 0; y < 60; ++y)
    for (Index x = 0; x < 90; ++x)
      for (const Ball& b : discs) {
        if (std::hypot(static_cast<double>(x) - b.x, static_cast<double>(y) - b.y) > 0.5 * b.radius) continue;
        result.labels[result.image.grid.index(x, y)] = 0;
        result.image.values[result.image.grid.index(x, y)] = 2;
      }
  return result;
}

TEST(Objects, ThatAreRingsAreWhole) {
  const Picture one = rings({{30, 30, 0, 15}});
  EXPECT_EQ(find_objects(one.image, one.labels).table.size(), 1U);
  const Picture two = rings({{25, 30, 0, 12}, {49, 30, 0, 13}});
  EXPECT_EQ(find_objects(two.image, two.labels, {.split = false}).table.size(), 1U);
  EXPECT_EQ(find_objects(two.image, two.labels).table.size(), 2U);
}

TEST(Objects, ShareABasinWhereTheyTouch) {
  std::vector<Ball> rods;
  for (double t = -19; t <= 19; t += 0.5) {
    rods.push_back({40 + t * std::cos(0.25), 14 - t * std::sin(0.25), 0, 5});
    rods.push_back({41.2 + t * std::cos(0.5), 30 + t * std::sin(0.5), 0, 5});
  }
  const Picture picture({90, 60, 1}, rods);
  EXPECT_EQ(find_objects(picture.image, picture.labels, {.split = false}).table.size(), 1U);
  EXPECT_EQ(find_objects(picture.image, picture.labels).table.size(), 2U);
}

// Square cells, close together, with darker walls: f(x) < 1 in the walls.
Picture tissue(std::array<Index, 3> cells, Index side) {
  Picture result({cells[0] * side + 12, cells[1] * side + 12, cells[2] == 0 ? 1 : cells[2] * side + 12}, {});
  const Grid& grid = result.image.grid;
  for (Index z = 0; z < grid.size[2]; ++z)
    for (Index y = 0; y < grid.size[1]; ++y)
      for (Index x = 0; x < grid.size[0]; ++x) {
        bool inside = true, wall = false;
        for (const auto& [at, many] : {std::pair{x, cells[0]}, {y, cells[1]}, {z, cells[2]}}) {
          if (many == 0) continue;
          inside = inside && at >= 6 && at < 6 + many * side;
          wall = wall || (at - 6) % side == 0 || (at - 5) % side == 0;
        }
        if (!inside) continue;
        const Index i = grid.index(x, y, z);
        result.labels[i] = 1;
        result.image.values[i] = wall ? 7 : 10;
      }
  return result;
}

TEST(Objects, AreSplitAtDarkWalls) {
  Picture plane = tissue({3, 2, 0}, 14);
  EXPECT_EQ(find_objects(plane.image, plane.labels).table.size(), 6U);
  for (float& value : plane.image.values) value = -value;
  EXPECT_EQ(find_objects(plane.image, plane.labels).table.size(), 6U);
  plane.image.values[3] = -1e30F;
  plane.image.values[5] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(find_objects(plane.image, plane.labels).table.size(), 6U);
  const Picture space = tissue({2, 1, 1}, 12);
  EXPECT_EQ(find_objects(space.image, space.labels).table.size(), 2U);
}

// Dark spots all over, which are no walls.
TEST(Objects, AreNotSplitByTheirTexture) {
  Picture picture({90, 60, 1}, {{28, 30, 0, 18}, {64, 30, 0, 16}});
  for (Index y = 0; y < 60; ++y)
    for (Index x = 0; x < 90; ++x) {
      const double wave = std::sin(0.9 * static_cast<double>(x)) + std::sin(1.1 * static_cast<double>(y) + 1);
      picture.image.values[picture.image.grid.index(x, y)] += static_cast<float>(wave);
    }
  EXPECT_EQ(find_objects(picture.image, picture.labels).table.size(), 2U);
}

TEST(Objects, SplitsTouchingBallsOfAnisotropicVoxels) {
  const Picture picture({60, 40, 14}, {{20, 20, 20, 11}, {39, 20, 20, 11}}, {1, 1, 3});
  const Objects found = find_objects(picture.image, picture.labels);
  ASSERT_EQ(found.table.size(), 2U);
  EXPECT_NEAR(found.table[0].centroid.x(), 20, 0.5);
  EXPECT_NEAR(found.table[1].centroid.x(), 39, 0.5);
}

TEST(Objects, AreMeasured) {
  const double radius = 11;
  const Picture disc({60, 50, 1}, {{30, 20, 0, radius}}, {1, 1, 1});
  const ObjectMeasure in_plane = find_objects(disc.image, disc.labels).table.at(0);
  EXPECT_NEAR(in_plane.volume, std::numbers::pi * radius * radius, 5);
  EXPECT_NEAR(in_plane.area / (2 * std::numbers::pi * radius), 1, 0.02);
  EXPECT_NEAR(in_plane.centroid.x(), 30, 1e-9);
  EXPECT_NEAR(in_plane.axes[0], 2 * radius, 0.3);
  EXPECT_NEAR(in_plane.axes[1], 2 * radius, 0.3);
  EXPECT_EQ(in_plane.axes[2], 0);
  EXPECT_NEAR(in_plane.sphericity, 1, 0.02);
  EXPECT_NEAR(in_plane.mean, 10, 1e-6);
  const Picture ball({50, 50, 25}, {{24, 24, 24, radius}}, {1, 1, 2});
  const ObjectMeasure in_space = find_objects(ball.image, ball.labels).table.at(0);
  EXPECT_NEAR(in_space.volume / (4.0 / 3 * std::numbers::pi * std::pow(radius, 3)), 1, 0.02);
  EXPECT_NEAR(in_space.area / (4 * std::numbers::pi * radius * radius), 1, 0.04);
  EXPECT_NEAR(in_space.axes[2], 2 * radius, 0.5);
  const Picture tube({60, 60, 1}, {{15, 15, 0, 6}, {19, 15, 0, 6}, {23, 15, 0, 6}, {27, 15, 0, 6}, {31, 15, 0, 6}});
  const ObjectMeasure longer = find_objects(tube.image, tube.labels).table.at(0);
  EXPECT_LT(longer.sphericity, 0.9);
  EXPECT_GT(longer.axes[0], 1.8 * longer.axes[1]);
}

// A radius of two voxels and more, in any place between them.
TEST(Objects, ThatAreSmallHaveTheirArea) {
  for (const double radius : {2.0, 3.0, 5.0}) {
    double length = 0, area = 0;
    constexpr int places = 10;
    for (int k = 0; k < places; ++k) {
      const double x = 12 + 0.31 * k, y = 11.5 + 0.17 * k, z = 12 - 0.23 * k;
      const Picture disc({25, 25, 1}, {{x, y, 0, radius}}, {1, 1, 1});
      const ObjectMeasure in_plane = find_objects(disc.image, disc.labels).table.at(0);
      const Picture ball({25, 25, 25}, {{x, y, z, radius}}, {1, 1, 1});
      const ObjectMeasure in_space = find_objects(ball.image, ball.labels).table.at(0);
      length += in_plane.area / (2 * std::numbers::pi * radius) / places;
      area += in_space.area / (4 * std::numbers::pi * radius * radius) / places;
      for (const ObjectMeasure& each : {in_plane, in_space}) {
        EXPECT_LE(each.sphericity, 1);
        EXPECT_GT(each.sphericity, 0.93) << radius;
      }
    }
    EXPECT_NEAR(length, 1, radius == 2 ? 0.06 : 0.03) << radius;
    EXPECT_NEAR(area, 1, radius == 2 ? 0.07 : 0.03) << radius;
  }
}

TEST(Objects, SmallerThanMinSizeAreLeftOutAndSuchHolesFilled) {
  Picture picture({60, 50, 1}, {{30, 20, 0, 10}, {50, 40, 0, 1.5}});
  picture.labels[static_cast<std::size_t>(picture.image.grid.index(30, 20))] = 0;
  const Objects all = find_objects(picture.image, picture.labels);
  EXPECT_EQ(all.labels[static_cast<std::size_t>(picture.image.grid.index(30, 20))], 0);
  const Objects large = find_objects(picture.image, picture.labels, {.min_size = 20});
  EXPECT_EQ(large.table.size(), 1U);
  EXPECT_EQ(large.labels[static_cast<std::size_t>(picture.image.grid.index(30, 20))], 1);
  EXPECT_EQ(large.labels[static_cast<std::size_t>(picture.image.grid.index(50, 40))], 0);
}

TEST(Objects, ThatAreSpecksBesideTheOthersAreLeftOut) {
  const std::vector<Ball> balls{{15, 15, 0, 8}, {45, 15, 0, 8}, {15, 40, 0, 8}, {45, 40, 0, 1.2}};
  const Picture picture({60, 55, 1}, balls);
  const Objects found = find_objects(picture.image, picture.labels);
  EXPECT_EQ(found.table.size(), 3U);
  EXPECT_EQ(found.left_out, 1);
  EXPECT_EQ(find_objects(picture.image, picture.labels, {.min_size = 1}).table.size(), 4U);
  // Where most are small, so is what is usual.
  const Picture dots({60, 55, 1}, {{15, 15, 0, 8}, {45, 15, 0, 1.2}, {15, 40, 0, 1.2}, {45, 40, 0, 1.2}});
  EXPECT_EQ(find_objects(dots.image, dots.labels).table.size(), 4U);
}

TEST(Objects, OfEmptyAndFullImagesAreNoneAndOne) {
  const Picture empty({20, 20, 1}, {});
  EXPECT_TRUE(find_objects(empty.image, empty.labels).table.empty());
  EXPECT_EQ(find_objects(empty.image, std::vector<std::uint8_t>(400, 1)).table.size(), 1U);
  EXPECT_THROW(find_objects(empty.image, std::vector<std::uint8_t>(3, 1)), InvalidInput);
  EXPECT_THROW(find_objects(empty.image, empty.labels, {.min_size = 0}), InvalidInput);
}

}  // namespace
}  // namespace csrbf::objects_test
