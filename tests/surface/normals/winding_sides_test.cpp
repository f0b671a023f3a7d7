#include "csrbf/surface/normals/winding_sides.hpp"

#include "surface/oriented_shapes.hpp"

namespace csrbf::winding_sides_test {
namespace {

WindingSides sides(const Shape& shape, const Points<3>& normals) {
  return winding_sides(shape.points, normals, Eigen::VectorXd::Constant(shape.size(), shape.spacing()));
}

TEST(WindingSides, TellASolidFromFlippedNormals) {
  const Shape sphere = even_sphere(3000);
  const WindingSides solid = sides(sphere, sphere.normals);
  EXPECT_NEAR(solid.mean, 0.5, 0.02);
  EXPECT_LT(solid.defect, 0.03);
  Points<3> flipped = sphere.normals;
  for (Index i = 0; i < sphere.size(); ++i)
    if (sphere.points(2, i) > 0.3) flipped.col(i) *= -1;
  EXPECT_GT(sides(sphere, flipped).defect, 5 * solid.defect);
  EXPECT_LT(solid.energy, 0.02);
  EXPECT_GT(sides(sphere, flipped).energy, 5 * solid.energy);
}

TEST(WindingSides, OfTwoSpheresInContactAreThoseOfSolids) {
  const Shape spheres = join(even_sphere(3000), even_sphere(3000, {2.001, 0, 0}));
  const WindingSides solid = sides(spheres, spheres.normals);
  EXPECT_NEAR(solid.mean, 0.5, 0.02);
  EXPECT_LT(solid.defect, 0.04);
}

TEST(WindingSides, OfASheetHaveNoInside) {
  Shape sheet = even_sphere(6000);
  std::vector<Index> cap;
  for (Index i = 0; i < sheet.size(); ++i)
    if (sheet.points(2, i) > 0.9) cap.push_back(i);
  const Shape open{sheet.points(Eigen::all, cap), sheet.normals(Eigen::all, cap), 0.05 * sheet.area};
  EXPECT_LT(std::abs(sides(open, open.normals).mean), 0.15);
}

}  // namespace
}  // namespace csrbf::winding_sides_test
