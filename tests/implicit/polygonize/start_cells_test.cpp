#include "csrbf/implicit/polygonize/start_cells.hpp"

#include "implicit/polygonize_fields.hpp"

#include <set>

namespace csrbf::polygonization::start_cells_test {
namespace {

using Key = std::array<int, 3>;

Key key_of(const Cell& cell) {
  return {cell[0], cell[1], cell[2]};
}

std::multiset<Key> keys_of(const std::vector<Cell>& cells) {
  std::multiset<Key> keys;
  for (const Cell& cell : cells) keys.insert(key_of(cell));
  return keys;
}

// Lower ends of the lattice edges with a sign change, in those stretches between every step-th corner whose ends
// differ: one in each, for the fields below.
std::multiset<Key> plain_scan(const Field<3>& field, const CellLattice& lattice, int step) {
  const auto inside = [&](const Cell& corner) {
    return !lattice.on_boundary(corner) && field(lattice.position(corner)) >= 0;
  };
  const auto scanned = [&](int axis) {
    std::vector<int> coordinates;
    for (int i = 0; i < lattice.cells[axis]; i += step) coordinates.push_back(i);
    coordinates.push_back(lattice.cells[axis]);
    return coordinates;
  };
  std::multiset<Key> found;
  for (int axis = 0; axis < 3; ++axis)
    for (const int z : scanned(2))
      for (const int y : scanned(1))
        for (const int x : scanned(0)) {
          const Cell first(x, y, z), edge = offset(1 << axis);
          const int length = std::min(step, lattice.cells[axis] - first[axis]);
          if (length == 0 || inside(first) == inside(first + length * edge)) continue;
          for (int i = 0; i < length; ++i)
            if (inside(first + i * edge) != inside(first + (i + 1) * edge)) found.insert(key_of(first + i * edge));
        }
  return found;
}

TEST(CellsByScan, AreAtEverySignChangeOfASmallLattice) {
  const CellLattice lattice{Point<3>(-2, -1.5, -1), Point<3>(0.25, 0.125, 0.25), Cell(18, 23, 11)};
  for (const std::uint64_t seed : {1, 2}) {
    const Implicit rough = noise(20, seed);
    const Implicit field([&](const Point<3>& p, Point<3>&) { return rough(2 * p + Point<3>(8, 8, 8)); }, cube(2));
    LevelSampler sampler(field, 0);
    EXPECT_EQ(keys_of(cells_by_scan(lattice, sampler, {})), plain_scan(field, lattice, 1));
    EXPECT_EQ(sampler.value_count(), 17 * 22 * 10);  // every corner once but those on the boundary
  }
}

TEST(CellsByScan, AreFoundByHalvingOnALongLattice) {
  const Point<3> normal = Point<3>(1, 0.4, -0.3).normalized();
  for (const auto& [length, step] : {std::pair{266, 1}, {267, 2}, {532, 2}, {533, 3}, {1000, 4}})
    for (const double at : {0.0137, 0.5031, 0.991}) {
      // Along each axis in turn.
      for (int axis = 0; axis < 3; ++axis) {
        Cell cells(7, 9, 10);
        cells[axis] = length;
        const CellLattice lattice{Point<3>::Zero(), Point<3>::Constant(0.5), cells};
        const Point<3> through = lattice.position(Cell::Zero()) + at * 0.5 * cells.matrix().cast<double>();
        const Implicit field([&](const Point<3>& p, Point<3>&) { return normal.dot(p - through); }, cube(1));
        LevelSampler sampler(field, 0);
        EXPECT_EQ(keys_of(cells_by_scan(lattice, sampler, {})), plain_scan(field, lattice, step))
            << length << " " << at;
      }
    }
}

// A plane across x at `at`, of slope 3.
Implicit wall(double at) {
  return {[=](const Point<3>& p, Point<3>& g) { return g = 3 * Point<3>::UnitX(), 3 * (p[0] - at); }, cube(1)};
}

const CellLattice seeded{Point<3>::Zero(), Point<3>(0.5, 1, 2), Cell(60, 30, 15)};

TEST(CellsNearSeeds, AreThreeNewtonStepsOfAtMostTwoCellsAway) {
  for (const double cells : {-9.0, -6.2, -5.7, -4.2, -3.0, -1.3, -0.04, 0.04, 0.3, 1.7, 3.4, 4.6, 5.5, 8.0}) {
    const Implicit field = wall(15.2);
    LevelSampler sampler(field, 0);
    const Point<3> seed(15.2 + 0.5 * cells, 20.3, 11.1);
    const std::vector<Cell> found = cells_near_seeds(seeded, sampler, seed);
    ASSERT_EQ(found.size(), 1U);
    const double left = std::copysign(std::max(0.0, std::abs(cells) - 6), cells);
    EXPECT_EQ(key_of(found[0]), key_of(seeded.cell_at({15.2 + 0.5 * left, 20.3, 11.1}))) << cells;
    // On a plane Newton arrives at once. A step of a tenth of a cell ends it without another look.
    const int steps = std::abs(cells) <= 0.1 ? 1 : static_cast<int>(std::ceil(std::abs(cells) / 2)) + 1;
    EXPECT_EQ(sampler.gradient_count(), std::min(3, steps)) << cells;
  }
}

TEST(CellsNearSeeds, CountSeedsOfACellOnceAndLeaveOutThoseOutside) {
  const Implicit field = wall(15.2);
  LevelSampler sampler(field, 0);
  const Points<3> seeds = columns({{14.1, 3.3, 7},
                                   {15.24, 20.3, 11.1},
                                   {14.1, 3.4, 7.1},
                                   {15.26, 20.4, 11.3},
                                   {-0.1, 3, 3},
                                   {3, 30.1, 3},
                                   {3, 3, 30.1},
                                   {30.1, 3, 3},
                                   {16.3, 3.6, 6.5},
                                   {15.21, 9.5, 1.5}});
  const std::vector<Cell> found = cells_near_seeds(seeded, sampler, seeds);
  // Along the Morton curve: two of them end in the same cell.
  EXPECT_EQ(keys_of(found), (std::multiset<Key>{{30, 3, 3}, {30, 20, 5}, {30, 9, 1}}));
  EXPECT_TRUE(std::is_sorted(found.begin(), found.end(),
                             [](const Cell& a, const Cell& b) { return morton_key(a) < morton_key(b); }));
}

TEST(CellsNearSeeds, StayWhereTheGradientVanishes) {
  const Implicit flat([](const Point<3>&, Point<3>& g) { return g.setZero(), 1.0; }, cube(1));
  LevelSampler sampler(flat, 0);
  const std::vector<Cell> found = cells_near_seeds(seeded, sampler, Point<3>(7.7, 8.8, 9.9));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(key_of(found[0]), (Key{15, 8, 4}));
  EXPECT_EQ(sampler.gradient_count(), 1);
}

}  // namespace
}  // namespace csrbf::polygonization::start_cells_test
