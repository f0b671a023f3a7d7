#include "csrbf/implicit/polygonize/brick_grid.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>

namespace csrbf::polygonization::brick_grid_test {
namespace {

CellLattice lattice_of(const Cell& cells) {
  return {Point<3>(-1, 2, 0.5), Point<3>(0.5, 0.25, 2), cells};
}

Cell random_cell(std::mt19937_64& random, int limit) {
  std::uniform_int_distribution<int> coordinate(0, limit - 1);
  return {coordinate(random), coordinate(random), coordinate(random)};
}

TEST(MortonKey, InterleavesTheBitsOfTheCoordinates) {
  std::mt19937_64 random(1);
  for (int trial = 0; trial < 500; ++trial) {
    const Cell cell = random_cell(random, 1 << 21);
    std::uint64_t expected = 0;
    for (int bit = 0; bit < 21; ++bit)
      for (int axis = 0; axis < 3; ++axis)
        expected |= static_cast<std::uint64_t>(cell[axis] >> bit & 1) << (3 * bit + axis);
    EXPECT_EQ(morton_key(cell), expected) << cell.transpose();
  }
}

TEST(CellLattice, KnowsItsCornersItsBoundaryAndItsCaps) {
  const CellLattice lattice = lattice_of({4, 6, 3});
  EXPECT_EQ(lattice.position({2, 3, 1}), Point<3>(0, 2.75, 2.5));
  for (int x = 0; x <= 4; ++x)
    for (int y = 0; y <= 6; ++y)
      for (int z = 0; z <= 3; ++z)
        EXPECT_EQ(lattice.on_boundary({x, y, z}), x == 0 || x == 4 || y == 0 || y == 6 || z == 0 || z == 3);
  EXPECT_TRUE(lattice.capped_box().lo.isApprox(lattice.position({1, 1, 1}) - 1e-3 * lattice.spacing));
  EXPECT_TRUE(lattice.capped_box().hi.isApprox(lattice.position({3, 5, 2}) + 1e-3 * lattice.spacing));
}

TEST(CellLattice, FindsTheCellOfAPointOrTheNearestOffTheBoundary) {
  const CellLattice lattice = lattice_of({8, 6, 5});
  for (int x = 0; x < 8; ++x)
    for (int y = 0; y < 6; ++y)
      for (int z = 0; z < 5; ++z) {
        const Point<3> inside = lattice.position({x, y, z}) + 0.75 * lattice.spacing;
        const Cell expected = Cell(x, y, z).max(1).min(Cell(6, 4, 3));
        EXPECT_TRUE((lattice.cell_at(inside) == expected).all()) << x << " " << y << " " << z;
      }
  EXPECT_TRUE((lattice.cell_at({1e9, -1e9, 3}) == Cell(6, 1, 1)).all());
}

TEST(BrickGrid, FindsTheBricksThatWereMadeAndNoOthers) {
  BrickGrid grid(lattice_of(Cell::Constant(400)));
  std::mt19937_64 random(2);
  std::map<std::uint64_t, Brick*> made;
  for (int trial = 0; trial < 3000; ++trial) {  // more than the table holds at first
    const Cell cell = random_cell(random, 400), brick = cell / 4;
    const std::uint64_t key = morton_key(brick);
    EXPECT_EQ(grid.find(cell), made.count(key) != 0 ? made[key] : nullptr);
    Brick& at = grid.at(cell);
    EXPECT_EQ(at.key, key);
    EXPECT_TRUE((at.first == 4 * brick).all());
    EXPECT_EQ(made.emplace(key, &at).first->second, &at);
  }
  const std::vector<Brick*> sorted = grid.sorted();
  ASSERT_EQ(sorted.size(), made.size());
  std::size_t i = 0;
  for (const auto& [key, brick] : made) EXPECT_EQ(sorted[i++], brick);
}

TEST(BrickGrid, LinksNeighbours) {
  BrickGrid grid(lattice_of(Cell::Constant(40)));
  Brick& brick = grid.at({17, 9, 22});
  for (int k = 0; k < 8; ++k) {
    Brick& upper = grid.upper(brick, k);
    EXPECT_TRUE((upper.first == brick.first + 4 * offset(k)).all());
    EXPECT_EQ(grid.find(upper.first), &upper);
    EXPECT_EQ(brick.upper[k], &upper);
  }
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(brick.upper[1 << axis]->lower[axis], &brick);
    Brick& lower = grid.lower(brick, axis);
    EXPECT_TRUE((lower.first == brick.first - 4 * offset(1 << axis)).all());
    EXPECT_EQ(lower.upper[1 << axis], &brick);
    EXPECT_EQ(grid.find(lower.first), &lower);
  }
}

TEST(BrickGrid, KnowsThatTheBoundaryIsOutside) {
  const Cell cells(8, 9, 6);
  BrickGrid grid(lattice_of(cells));
  for (int x = 0; x <= cells[0]; x += 4)
    for (int y = 0; y <= cells[1]; y += 4)
      for (int z = 0; z <= cells[2]; z += 4) {
        const Brick& brick = grid.at({x, y, z});
        EXPECT_EQ(brick.inside, 0U);
        for (int bit = 0; bit < 64; ++bit) {
          const bool boundary = grid.lattice().on_boundary(brick.corner(bit));
          EXPECT_EQ(brick.known >> bit & 1, boundary ? 1U : 0U);
          if (!boundary) continue;
          EXPECT_EQ(brick.value[bit], 0);
        }
      }
}

TEST(InsideCorners, AreThoseOfTheBrickAndItsUpperNeighbours) {
  BrickGrid grid(lattice_of(Cell::Constant(20)));
  std::mt19937_64 random(3);
  Brick& brick = grid.at({5, 6, 7});
  for (int k = 0; k < 8; ++k) {
    if (k == 5) continue;  // a neighbour that is not known counts as outside
    Brick& upper = grid.upper(brick, k);
    upper.inside = random();
    for (double& value : upper.value) value = static_cast<double>(random());
  }
  const Octet inside = inside_corners(brick);
  for (int bit = 0; bit < 64; ++bit)
    for (int d = 0; d < 8; ++d) {
      const Cell corner = brick.corner(bit) + offset(d), in_brick = corner - corner / 4 * 4;
      const Brick* holder = grid.find(corner);
      const int at = in_brick[0] + 4 * in_brick[1] + 16 * in_brick[2];
      EXPECT_EQ(inside[d] >> bit & 1, holder == nullptr ? 0 : holder->inside >> at & 1);
      if (holder == nullptr) continue;
      EXPECT_EQ(corner_at(brick, bit, d).value(), holder->value[at]);
    }
}

}  // namespace
}  // namespace csrbf::polygonization::brick_grid_test
