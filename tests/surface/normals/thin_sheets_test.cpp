#include "csrbf/surface/normals/thin_sheets.hpp"

#include "csrbf/spatial/morton_order.hpp"
#include "surface/oriented_shapes.hpp"

namespace csrbf::thin_sheets_test {
namespace {

Shape in_morton_order(const Shape& shape) {
  const std::vector<Index> order = morton_order<3>(shape.points);
  return {shape.points(Eigen::all, order), shape.normals(Eigen::all, order), shape.area};
}

Shape with_noise(Shape shape, double deviation) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal(0, deviation);
  for (double& x : shape.points.reshaped()) x += normal(random);
  return shape;
}

ThinSheets sheets_of(const Shape& shape) {
  return thin_sheets(shape.points, KdTree<3>(shape.points));
}

// Shares of the points with a sheet, and of these the ones whose normals are within 30 degrees.
struct Shares {
  double found = 0, right = 0;
};

Shares shares(const Shape& shape, const ThinSheets& sheets) {
  Shares result;
  for (Index i = 0; i < shape.size(); ++i) {
    if (!sheets.has(i)) continue;
    result.found += 1.0 / static_cast<double>(shape.size());
    result.right += sheets.normals.col(i).dot(shape.normals.col(i)) > 0.866 ? 1 : 0;
  }
  result.right /= result.found * static_cast<double>(shape.size());
  return result;
}

TEST(ThinSheets, OfAWallPointAwayFromEachOther) {
  for (const double thickness : {0.2, 0.5, 1.0}) {
    const Shape bowl = in_morton_order(random_bowl(10'000, thickness, 1));
    const ThinSheets sheets = sheets_of(bowl);
    ASSERT_TRUE(sheets.any()) << thickness;
    const Shares share = shares(bowl, sheets);
    EXPECT_GT(share.found, 0.95) << thickness;
    EXPECT_GT(share.right, 0.98) << thickness;
    EXPECT_LT(sheets.noise, 0.05 * thickness * bowl.spacing()) << thickness;
  }
}

TEST(ThinSheets, AreFoundInALittleNoise) {
  const Shape clean = random_bowl(10'000, 1, 2);
  const double deviation = 0.1 * clean.spacing();
  const Shape bowl = in_morton_order(with_noise(clean, deviation));
  const ThinSheets sheets = sheets_of(bowl);
  ASSERT_TRUE(sheets.any());
  EXPECT_GT(shares(bowl, sheets).found, 0.9);
  EXPECT_GT(shares(bowl, sheets).right, 0.97);
  EXPECT_NEAR(sheets.noise, deviation, 0.2 * deviation);
}

TEST(ThinSheets, AreNotSeenInNoiseOrOnCreases) {
  const Shape torus = random_torus(10'000, 3);
  EXPECT_FALSE(sheets_of(in_morton_order(torus)).any());
  for (const double spacings : {0.1, 0.5, 2.0})
    EXPECT_FALSE(sheets_of(in_morton_order(with_noise(torus, spacings * torus.spacing()))).any()) << spacings;
  EXPECT_FALSE(sheets_of(in_morton_order(random_box({1, 1, 1}, 0.05, 4))).any());
}

TEST(ThinSheets, NeedEnoughPoints) {
  const Shape few = in_morton_order(random_torus(40, 1));
  EXPECT_FALSE(sheets_of(few).any());
}

}  // namespace
}  // namespace csrbf::thin_sheets_test
