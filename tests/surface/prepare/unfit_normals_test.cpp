#include "csrbf/surface/prepare/unfit_normals.hpp"

#include "surface/surface_testing.hpp"

namespace csrbf::unfit_normals_test {
namespace {

// Two groups of equal normals, some of which equal those of both.
TEST(UnfitNormals, NormalsOfOverlappingGroupsCountOnce) {
  constexpr Index n = 4000;
  const PointCloud cloud = sphere_cloud(n);
  const Point<3> first(0, 0, 1), between(0.8e-5, 0, 1), second(1.4e-5, 0, 1);
  for (const unsigned often : {2U, 6U}) {  // which of the second group are more
    Points<3> normals = cloud.normals;
    std::mt19937_64 random(1);
    for (Index i = 0; i < n; i += 2) {
      const auto k = random() % 10;
      normals.col(i) = k >= 8 ? first : k < often ? between : second;
    }
    const NeighborTable near = make_neighbor_table(cloud.points, KdTree<3>(cloud.points), 9);
    const UnfitNormals unfit = clear_unfit_normals(cloud.points, near, normals);
    EXPECT_EQ(unfit.unset, n / 2);
    EXPECT_GT(unfit.value.norm(), 0.9);
    for (Index i = 0; i < n; ++i) EXPECT_EQ(normals.col(i).isZero(), i % 2 == 0);
  }
}

}  // namespace
}  // namespace csrbf::unfit_normals_test
