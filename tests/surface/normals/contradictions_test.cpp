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

TEST(Contradictions, OfWrongSignsAreNotOfSheets) {
  const auto of_sheets = [](const Points<3>& points, const Points<3>& normals) {
    const NeighborTable near = make_neighbor_table(points, KdTree<3>(points), 12);
    return Contradictions(points, normals, near).are_of_sheets(normals);
  };
  for (const double thickness : {0.3, 1.0}) {
    const Shape bowl = random_bowl(5000, thickness, 6);
    EXPECT_TRUE(of_sheets(bowl.points, bowl.normals)) << thickness;
    EXPECT_TRUE(of_sheets(bowl.points, -bowl.normals)) << thickness;
  }
  const Shape torus = random_torus(5000, 7);
  EXPECT_FALSE(of_sheets(torus.points, scrambled(torus.normals, 8)));
}

Index on_seams(const Points<3>& points, const Points<3>& normals) {
  const NeighborTable near = make_neighbor_table(points, KdTree<3>(points), 12);
  return Contradictions(points, normals, near).on_seams(normals);
}

TEST(Contradictions, LieOnSeamsWhereASheetChangesSides) {
  const Shape torus = random_torus(5000, 4), bowl = random_bowl(5000, 0.5, 5);
  EXPECT_EQ(on_seams(torus.points, torus.normals), 0);
  EXPECT_LT(on_seams(bowl.points, bowl.normals), 20);
  Points<3> half = torus.normals;
  for (Index i = 0; i < half.cols(); ++i)
    if (torus.points(0, i) < 0) half.col(i) *= -1;
  const double seams = 2 * 2 * std::numbers::pi * torus_minor / torus.spacing();  // two circles
  EXPECT_GT(on_seams(torus.points, half), 2 * seams);
  EXPECT_LT(on_seams(torus.points, half), 5 * seams);
}

TEST(Contradictions, CutASheetOnlyIfOthersDoNot) {
  const Shape torus = random_torus(5000, 4);
  const NeighborTable near = make_neighbor_table(torus.points, KdTree<3>(torus.points), 12);
  Points<3> half = torus.normals, other_half = half;
  for (Index i = 0; i < half.cols(); ++i) (torus.points(0, i) < 0 ? half : other_half).col(i) *= -1;
  EXPECT_TRUE(cuts_sheet(torus.points, near, half, torus.normals));
  EXPECT_FALSE(cuts_sheet(torus.points, near, half, other_half));
  EXPECT_FALSE(cuts_sheet(torus.points, near, torus.normals, half));
}

}  // namespace
}  // namespace csrbf::contradictions_test
