#include "csrbf/core/grid_tiles.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace csrbf::grid_tiles_test {
namespace {

template <int Dim>
GridAxes<Dim> axes_of(const std::array<Index, Dim>& sizes) {
  GridAxes<Dim> axes;
  for (std::size_t a = 0; a < Dim; ++a) axes[a] = Eigen::VectorXd::LinSpaced(sizes[a], 0, 1);
  return axes;
}

// How often the rows of all tiles visit each node; the node's number is checked against its indices.
template <int Dim>
std::vector<int> visits(const std::array<Index, Dim>& sizes, Index nodes_per_tile) {
  const GridTiles<Dim> tiles(axes_of<Dim>(sizes), nodes_per_tile);
  std::vector<int> count(tiles.nodes(), 0);
  for (Index i = 0; i < tiles.size(); ++i) {
    const GridTile<Dim> tile = tiles[i];
    EXPECT_LE(tile.nodes(), nodes_per_tile);
    tiles.for_each_row(tile, [&](const std::array<Index, Dim>& node, Index first) {
      Index number = 0;
      for (std::size_t a = Dim; a-- > 0;) number = number * sizes[a] + node[a];
      EXPECT_EQ(number, first);
      for (Index k = 0; k < tile.size(0); ++k) ++count[first + k];
    });
  }
  return count;
}

TEST(GridTiles, CoverEveryNodeOnce) {
  for (const Index nodes_per_tile : {1, 7, 64, 512, 100000}) {
    EXPECT_EQ(visits<1>({1000}, nodes_per_tile), std::vector<int>(1000, 1));
    EXPECT_EQ(visits<2>({37, 53}, nodes_per_tile), std::vector<int>(37 * 53, 1));
    EXPECT_EQ(visits<3>({1, 40, 9}, nodes_per_tile), std::vector<int>(40 * 9, 1));
    EXPECT_EQ(visits<4>({5, 6, 1, 7}, nodes_per_tile), std::vector<int>(5 * 6 * 7, 1));
  }
}

TEST(GridTiles, AreAboutCubes) {
  const GridTiles<3> tiles(axes_of<3>({100, 100, 100}), 512);
  for (int a = 0; a < 3; ++a) EXPECT_EQ(tiles[0].size(a), 8);
}

TEST(GridTiles, FillThemselvesAlongTheLongAxes) {
  const GridTiles<3> tiles(axes_of<3>({100, 100, 1}), 400);
  EXPECT_EQ(tiles[0].nodes(), 400);
}

TEST(GridTiles, OfAnEmptyGridAreNone) {
  EXPECT_EQ(GridTiles<2>(axes_of<2>({0, 5}), 64).size(), 0);
  EXPECT_EQ(GridTiles<2>(axes_of<2>({5, 0}), 64).nodes(), 0);
}

}  // namespace
}  // namespace csrbf::grid_tiles_test
