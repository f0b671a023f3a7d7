#include "csrbf/approx/images/grid_spline.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace csrbf::grid_spline_test {
namespace {

Grid grid_of(Index nx, Index ny, Index nz = 1) {
  Grid grid;
  grid.size = {nx, ny, nz};
  grid.axes = nz > 1 ? 3 : 2;
  return grid;
}

std::vector<std::uint8_t> box_in_the_middle(const Grid& grid) {
  std::vector<std::uint8_t> unknown;
  for (Index z = 0; z < grid.size[2]; ++z)
    for (Index y = 0; y < grid.size[1]; ++y)
      for (Index x = 0; x < grid.size[0]; ++x) {
        const bool deep = grid.size[2] == 1 || (z > 2 && z < grid.size[2] - 3);
        unknown.push_back(x > 3 && x < grid.size[0] - 5 && y > 2 && y < grid.size[1] - 4 && deep ? 1 : 0);
      }
  return unknown;
}

template <class F>
Eigen::MatrixXd values_of(const Grid& grid, const F& f) {
  Eigen::MatrixXd values(grid.voxels(), 1);
  for (Index z = 0; z < grid.size[2]; ++z)
    for (Index y = 0; y < grid.size[1]; ++y)
      for (Index x = 0; x < grid.size[0]; ++x)
        values(grid.index(x, y, z), 0) =
            f(static_cast<double>(x) * grid.spacing.x(), static_cast<double>(y) * grid.spacing.y(),
              static_cast<double>(z) * grid.spacing.z());
  return values;
}

Eigen::MatrixXd spoiled(Eigen::MatrixXd values, const std::vector<std::uint8_t>& unknown) {
  for (std::size_t i = 0; i < unknown.size(); ++i)
    if (unknown[i] != 0) values.row(static_cast<Index>(i)).setConstant(std::nan(""));
  return values;
}

TEST(GridSpline, RestoresPlanesWithAnyTensionInThePlaneAndInSpace) {
  for (Grid grid : {grid_of(17, 15), grid_of(14, 13, 12)}) {
    grid.spacing = Point<3>(1, 2, 1.5);
    const Eigen::MatrixXd truth = values_of(grid, [](double x, double y, double z) { return 3 + x - 2 * y + z; });
    const std::vector<std::uint8_t> unknown = box_in_the_middle(grid);
    for (const double tension : {0.0, 0.1, 10.0}) {
      Eigen::MatrixXd values = spoiled(truth, unknown);
      fill_by_grid_spline(grid, unknown, tension, values);
      constexpr double round_off = 1e-6;
      EXPECT_LT((values - truth).cwiseAbs().maxCoeff(), round_off) << tension;
    }
  }
}

// Cubic polynomials that are biharmonic are so for the differences, too: of degree 3 they are exact.
TEST(GridSpline, WithoutTensionRestoresCubics) {
  const Grid grid = grid_of(20, 18);
  const Eigen::MatrixXd truth =
      values_of(grid, [](double x, double y, double) { return x * x * y - y * y * y + x * x; });
  const std::vector<std::uint8_t> unknown = box_in_the_middle(grid);
  Eigen::MatrixXd values = spoiled(truth, unknown);
  fill_by_grid_spline(grid, unknown, 0, values);
  constexpr double tolerance = 1e-4;  // of values up to 6000
  EXPECT_LT((values - truth).cwiseAbs().maxCoeff(), tolerance);
}

TEST(GridSpline, OfMuchTensionStaysBetweenTheKnownValues) {
  const Grid grid = grid_of(30, 24);
  const auto step = [](double x, double y, double) { return x + 0.3 * y > 16 ? 1.0 : 0.0; };
  const std::vector<std::uint8_t> unknown = box_in_the_middle(grid);
  Eigen::MatrixXd plate = spoiled(values_of(grid, step), unknown), membrane = plate;
  fill_by_grid_spline(grid, unknown, 0, plate);
  fill_by_grid_spline(grid, unknown, 1e6, membrane);
  EXPECT_LT(plate.minCoeff(), -0.01);
  constexpr double nearly = 1e-4;
  EXPECT_GT(membrane.minCoeff(), -nearly);
  EXPECT_LT(membrane.maxCoeff(), 1 + nearly);
}

}  // namespace
}  // namespace csrbf::grid_spline_test
