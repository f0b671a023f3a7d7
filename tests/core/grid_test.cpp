#include "csrbf/core/grid.hpp"
#include "csrbf/core/error.hpp"

#include <Eigen/Geometry>

#include <gtest/gtest.h>

namespace csrbf::grid_test {
namespace {

constexpr double rounding = 1e-13;

Grid oblique_grid() {
  Grid grid;
  grid.size = {4, 3, 2};
  grid.spacing = {0.5, 2, 3};
  grid.origin = {-10, 20, 5};
  grid.direction = Eigen::AngleAxisd(0.4, Point<3>(1, 2, 3).normalized()).toRotationMatrix();
  return grid;
}

TEST(Grid, PlacesVoxelsAtOriginPlusStepsAlongItsAxes) {
  const Grid grid = oblique_grid();
  const auto map = grid.to_physical<3>();
  EXPECT_EQ(map * Point<3>(0, 0, 0), grid.origin);
  EXPECT_TRUE((map * Point<3>(2, 0, 0)).isApprox(grid.origin + grid.direction.col(0), rounding));
  EXPECT_TRUE((map * Point<3>(0, 1, 0)).isApprox(grid.origin + 2 * grid.direction.col(1), rounding));
}

TEST(Grid, TellsItsSizeAndItsVoxels) {
  Grid grid = oblique_grid();
  EXPECT_EQ(size_text(grid), "4 x 3 x 2");
  EXPECT_EQ(voxel_text(grid, grid.index(3, 0, 1)), "3, 0, 1");
  grid.size = {4, 3, 1};
  EXPECT_EQ(size_text(grid), "4 x 3 x 1");
  EXPECT_EQ(voxel_text(grid, grid.index(1, 2)), "1, 2");
  grid.axes = 2;
  EXPECT_EQ(size_text(grid), "4 x 3");
}

TEST(Grid, MapsBackToVoxels) {
  const Grid grid = oblique_grid();
  const Points<3> voxels = Points<3>::Random(3, 20);
  EXPECT_TRUE((grid.to_voxel<3>() * (grid.to_physical<3>() * voxels).eval()).isApprox(voxels, rounding));
  Grid flat;
  flat.spacing = {2, 4, 1};
  flat.origin = {1, 1, 7};
  EXPECT_EQ(flat.to_voxel<2>() * Point<2>(5, 9), Point<2>(2, 2));
  EXPECT_EQ(flat.to_voxel<1>() * Point<1>(5), Point<1>(2));
}

TEST(Grid, ListsTheCentresOfItsVoxelsWithXFastest) {
  const Grid grid = oblique_grid();
  const Points<3> centers = grid.centers<3>();
  ASSERT_EQ(centers.cols(), grid.voxels());
  EXPECT_TRUE(centers.col(grid.index(3, 2, 1)).isApprox(grid.to_physical<3>() * Point<3>(3, 2, 1), rounding));
  EXPECT_TRUE(centers.col(1).isApprox(grid.to_physical<3>() * Point<3>(1, 0, 0), rounding));
  Grid flat;
  flat.size = {2, 3, 1};
  EXPECT_EQ(flat.centers<2>().col(3), Point<2>(1, 1));
}

TEST(Grid, IgnoresTrailingAxesOfOneVoxelInItsDimension) {
  Grid grid;
  EXPECT_EQ(grid.dimension(), 1);
  grid.size = {1, 5, 1};
  EXPECT_EQ(grid.dimension(), 2);
  grid.size = {1, 1, 5};
  EXPECT_EQ(grid.dimension(), 3);
}

TEST(Volume, ShowsItsFramesAsComponentsByVoxels) {
  VolumeLayout layout;
  layout.grid.size = {3, 2, 1};
  layout.frames = 2;
  layout.components = 2;
  Volume<float> volume(layout, 7);
  volume.frame(1)(1, 5) = 3;
  EXPECT_EQ(volume.values.size(), 24u);
  EXPECT_EQ(volume.values.back(), 3);
  EXPECT_EQ(volume.frame(0).sum(), 84);
}

template <class Run>
std::string failure(Run run) {
  try {
    run();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "no exception";
}

TEST(Grid, RefusesDimensionsThatItDoesNotSpan) {
  EXPECT_EQ(failure([] { return oblique_grid().centers<2>(); }),
            "Grid::centers: dimension of the grid = 3: must not exceed the dimension of the points");
  Grid sagittal;
  sagittal.direction << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  EXPECT_EQ(failure([&] { return sagittal.to_voxel<2>(); }),
            "Grid::to_voxel: determinant of the directions = 0: must not be 0: the axes of the image must span the "
            "first axes of space");
}

}  // namespace
}  // namespace csrbf::grid_test
