#include "csrbf/levelset/partition/partition_contours.hpp"

#include "csrbf/levelset/contour/contour_energy.hpp"
#include "levelset/levelset_testing.hpp"

#include <gtest/gtest.h>

namespace csrbf {
namespace {

const Point<3> middle(32, 30, 0);

// The border of a disc of that radius on a lattice.
VariationalResult contour_of_disc(const Lattice<2>& lattice, const Grid& grid, double radius) {
  std::vector<float> force;  // -2 to 2
  const Points<3> centers = grid.centers<3>();
  for (Index i = 0; i < grid.voxels(); ++i)
    force.push_back(static_cast<float>(std::clamp((centers.col(i) - middle).norm() - radius, -2.0, 2.0)));
  VariationalResult contour;
  contour.labels.resize(force.size());
  contour.coefficients.assign(1, std::vector<float>(static_cast<std::size_t>(lattice.array_size()), 0.0F));
  fit_target(lattice, ContourEnergy{force.data()}, 20, contour.coefficients[0]);
  update_labels(lattice, contour.coefficients[0], contour.labels.data());
  return contour;
}

double area(const std::vector<std::uint8_t>& labels) {
  return static_cast<double>(std::count(labels.begin(), labels.end(), std::uint8_t{1}));
}

TEST(ContourLevel, IsWhereTheImageIsLikeliest) {
  const Grid grid = square_grid(64);
  const TestImage disc = two_level_image(
      grid, [](const Point<3>& p) { return 20 - (p - middle).norm(); }, 1, 0, 0.5);
  PartitionPrice price(disc.values, -2, 3, grid, {}, contour_weight(grid, 1.5));
  const Lattice<2> lattice(grid.size, grid.spacing, {3, 2.5});
  for (const double off : {-0.6, 0.6}) {
    VariationalResult contour = contour_of_disc(lattice, grid, 20 + off);
    const double before = std::abs(area(contour.labels) / area(disc.truth) - 1);
    EXPECT_NEAR(place_contour_level(price, {}, lattice, contour), -off, 0.25) << off;
    EXPECT_LT(std::abs(area(contour.labels) / area(disc.truth) - 1), 0.4 * before) << off;
  }
  VariationalResult right = contour_of_disc(lattice, grid, 20);
  const std::vector<std::uint8_t> labels = right.labels;
  EXPECT_EQ(place_contour_level(price, {}, lattice, right), 0);
  EXPECT_EQ(right.labels, labels);
}

}  // namespace
}  // namespace csrbf
