#include "csrbf/surface/prepare/decimate.hpp"

#include "csrbf/surface/prepare/prepare.hpp"
#include "surface/surface_testing.hpp"

namespace csrbf::decimate_test {
namespace {

TEST(Decimate, KeepsOneSampleForUpToFour) {
  const PreparedCloud prepared = prepare(sphere_cloud(8000), Normals::file);
  const OrientedPoints coarse = decimate(prepared.cloud);
  EXPECT_GT(coarse.size(), 1999);
  EXPECT_LT(coarse.size(), 2900);
  // They stand for the same area.
  EXPECT_NEAR(coarse.spacing.squaredNorm() / prepared.cloud.spacing.squaredNorm(), 1, 1e-12);
  for (Index i = 0; i < coarse.size(); ++i) {
    Index nearest = 0;
    double d2 = 1;
    prepared.tree->nearest(coarse.points.col(i), 1, &nearest, &d2);
    EXPECT_EQ(d2, 0);
    EXPECT_GT(coarse.normals.col(i).dot(prepared.cloud.normals.col(nearest)), 0.97);
  }
}

}  // namespace
}  // namespace csrbf::decimate_test
