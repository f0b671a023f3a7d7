#include "csrbf/surface/normals/orientation_energy.hpp"

#include <gtest/gtest.h>

namespace csrbf::orientation_energy_test {
namespace {

using namespace orientation;

// Ground (cluster 0) with a box without bottom on it (cluster 1), whose sides begin at some height. It may have a rim,
// part of the ground that faces down if the box faces outward: neighbours join both where the box faces inward.
struct Scene {
  Points<3> points, normals;
  Clusters clusters;

  explicit Scene(double height, bool has_rim = false) {
    constexpr int cells = 40;  // of the ground along one side
    constexpr double step = 2.0 / cells, half = 0.4;
    std::vector<Point<3>> at, normal;
    const auto add = [&](const Point<3>& x, const Point<3>& n, std::int32_t cluster) {
      at.push_back(x);
      normal.push_back(n);
      clusters.of.push_back(cluster);
    };
    for (double x = -1 + step / 2; x < 1; x += step)
      for (double y = -1 + step / 2; y < 1; y += step) {
        const double distance = std::max(std::abs(x), std::abs(y)) - half;
        const bool on_rim = has_rim && distance < step;
        if (distance > 0) add({x, y, 0}, {0, 0, on_rim ? -1.0 : 1.0}, on_rim ? 1 : 0);
      }
    for (double x = -half + step / 2; x < half; x += step) {
      for (double y = -half + step / 2; y < half; y += step) add({x, y, 2 * half}, {0, 0, 1}, 1);
      for (double z = height; z < 2 * half; z += step)
        for (const double side : {-1.0, 1.0}) {
          add({side * half, x, z}, {side, 0, 0}, 1);
          add({x, side * half, z}, {0, side, 0}, 1);
        }
    }
    points.resize(3, std::ssize(at));
    normals.resize(3, std::ssize(at));
    for (Index i = 0; i < points.cols(); ++i) {
      points.col(i) = at[i];
      normals.col(i) = normal[i];
    }
    clusters.sign.assign(at.size(), 1);
    clusters.tree_sign = {1, 1};
    clusters.parent = {-1, 0};
  }

  [[nodiscard]] Energy energy() const {
    const NeighborTable table = make_neighbor_table(points, KdTree<3>(points), 12);
    return {points, normals, table, make_graph(points, normals, table), clusters};
  }
};

TEST(OrientationEnergy, BodiesOnTheGroundAreTurnedOutwardIfHardlyJoinedToIt) {
  const Energy loose = Scene(0.05).energy();
  Signs signs = {1, -1};
  EXPECT_TRUE(loose.turn_bodies_outward(signs, 0.3));
  EXPECT_EQ(signs, Signs({1, 1}));
  EXPECT_FALSE(loose.turn_bodies_outward(signs, 0.3));
  signs = {-1, 1};  // the ground is no body
  EXPECT_FALSE(loose.turn_bodies_outward(signs, 0.3));
  EXPECT_EQ(signs, Signs({-1, 1}));
  signs = {1, -1};
  EXPECT_FALSE(Scene(0.05, true).energy().turn_bodies_outward(signs, 0.3));
  EXPECT_EQ(signs, Signs({1, -1}));
}

}  // namespace
}  // namespace csrbf::orientation_energy_test
