#include "csrbf/surface/normals/contradictions.hpp"

#include "csrbf/spatial/morton_order.hpp"
#include "surface/oriented_shapes.hpp"

namespace csrbf::contradictions_test {
namespace {

double share(const Points<3>& points, const Points<3>& normals) {
  const NeighborTable near = make_neighbor_table(points, KdTree<3>(points), 9);
  return Contradictions(points, normals, near).share(normals);
}

TEST(Contradictions, AreNotTheTwoSheetsOfAThinWall) {
  for (const double thickness : {0.3, 0.5, 1.0}) {
    const Shape bowl = random_bowl(5000, thickness, 1);
    EXPECT_LT(share(bowl.points, bowl.normals), 0.002) << thickness;
  }
}

TEST(Contradictions, AreFlippedNormalsOfNeighbours) {
  const Shape torus = random_torus(5000, 2);
  EXPECT_EQ(share(torus.points, torus.normals), 0);
  Points<3> flipped = torus.normals;
  for (Index i = 0; i < flipped.cols(); i += 10) flipped.col(i) *= -1;
  EXPECT_NEAR(share(torus.points, flipped), 2 * 0.1 * 0.9, 0.03);
}

TEST(Contradictions, AreSeenInNoise) {
  const Shape exact = random_torus(5000, 3), noisy = random_torus(5000, 3, 0.3 * exact.spacing());
  Points<3> flipped = noisy.normals;
  for (Index i = 0; i < flipped.cols(); i += 10) flipped.col(i) *= -1;
  EXPECT_GT(share(noisy.points, flipped), 0.1);
}

}  // namespace
}  // namespace csrbf::contradictions_test
