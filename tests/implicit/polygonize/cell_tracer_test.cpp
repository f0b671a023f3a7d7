#include "csrbf/implicit/polygonize/cell_tracer.hpp"

#include "implicit/polygonize_fields.hpp"

#include <map>
#include <set>

namespace csrbf::polygonization::cell_tracer_test {
namespace {

using Key = std::array<int, 3>;

Key key_of(const Cell& cell) {
  return {cell[0], cell[1], cell[2]};
}

// What there is to know about a lattice, corner by corner.
struct Plain {
  Plain(const Field<3>& given_field, const CellLattice& given_lattice) : field(given_field), lattice(given_lattice) {}

  [[nodiscard]] bool inside(const Cell& corner) const {
    return !lattice.on_boundary(corner) && field(lattice.position(corner)) >= 0;
  }
  // Are the corners of a cell, or of its face on one side along an axis, on both sides of the surface?
  [[nodiscard]] bool crossed(const Cell& cell, int axis = -1, int side = 0) const {
    int count = 0, corners = 0;
    for (int d = 0; d < 8; ++d) {
      if (axis >= 0 && (d >> axis & 1) != side) continue;
      count += inside(cell + offset(d));
      ++corners;
    }
    return count > 0 && count < corners;
  }

  const Field<3>& field;
  CellLattice lattice;
};

// Cells reached from a start, and after how many steps each.
std::map<Key, int> reached(const Plain& plain, const Cell& start) {
  std::map<Key, int> steps{{key_of(start), 0}};
  std::vector<Cell> front{start};
  for (int step = 1; !front.empty(); ++step) {
    std::vector<Cell> next;
    for (const Cell& cell : front)
      for (int axis = 0; axis < 3; ++axis)
        for (int side = 0; side < 2; ++side) {
          const Cell neighbour = cell + (2 * side - 1) * offset(1 << axis);
          if (plain.crossed(cell, axis, side) && steps.emplace(key_of(neighbour), step).second)
            next.push_back(neighbour);
        }
    front = std::move(next);
  }
  return steps;
}

template <class Visit>
void for_each_cell(const CellLattice& lattice, const Visit& visit) {
  for (int z = 0; z < lattice.cells[2]; ++z)
    for (int y = 0; y < lattice.cells[1]; ++y)
      for (int x = 0; x < lattice.cells[0]; ++x) visit(Cell(x, y, z));
}

Index corners_of(const std::map<Key, int>& cells, const CellLattice& lattice) {
  std::set<Key> corners;
  for (const auto& [key, step] : cells)
    for (int d = 0; d < 8; ++d) {
      const Cell corner = Cell(key[0], key[1], key[2]) + offset(d);
      if (!lattice.on_boundary(corner)) corners.insert(key_of(corner));
    }
  return static_cast<Index>(corners.size());
}

// Lattice spacings that are powers of two: positions are exact.
const CellLattice lattice{Point<3>(-2, -1.5, -1), Point<3>(0.25, 0.125, 0.25), Cell(17, 21, 9)};

TEST(CellTracer, VisitsWhatIsConnectedToItsStartAndSamplesEveryCornerOnce) {
  const Implicit rough = noise(20, 5);
  const Implicit field([&](const Point<3>& p, Point<3>&) { return rough(2 * p + Point<3>(8, 8, 8)); }, cube(2));
  const Plain plain(field, lattice);
  int tried = 0;
  for_each_cell(lattice, [&](const Cell& start) {
    if ((start[0] + 3 * start[1] + 5 * start[2]) % 97 != 0) return;
    LevelSampler sampler(field, 0);
    CellTracer tracer(lattice, sampler);
    tracer.add(start);
    tracer.run({});
    const std::map<Key, int> cells = reached(plain, start);
    Index active = 0;
    int waves = 0;
    for_each_cell(lattice, [&](const Cell& cell) {
      const auto found = cells.find(key_of(cell));
      const bool expected = found != cells.end() && plain.crossed(cell);
      EXPECT_EQ(tracer.active(cell), expected);
      active += expected;
      if (found != cells.end()) waves = std::max(waves, found->second + 1);
    });
    EXPECT_EQ(tracer.active_cells(), active);
    EXPECT_EQ(tracer.waves(), waves);
    EXPECT_EQ(sampler.value_count(), corners_of(cells, lattice));
    ++tried;
  });
  EXPECT_GT(tried, 10);
}

TEST(CellTracer, GivesTheCrossedEdgesOfItsCellsAndTheNeighboursThatHoldTheirEnds) {
  const Implicit rough = noise(20, 6);
  const Implicit field([&](const Point<3>& p, Point<3>&) { return rough(2 * p + Point<3>(8, 8, 8)); }, cube(2));
  const Plain plain(field, lattice);
  LevelSampler sampler(field, 0);
  CellTracer tracer(lattice, sampler);
  for_each_cell(lattice, [&](const Cell& cell) { tracer.add(cell); });
  tracer.run({});
  const std::vector<Brick*> bricks = tracer.finish(all_directions);
  EXPECT_TRUE(std::is_sorted(bricks.begin(), bricks.end(), [](auto* a, auto* b) { return a->key < b->key; }));
  Index found = 0, expected = 0;
  for (const Brick* brick : bricks)
    for (int bit = 0; bit < 64; ++bit)
      for (const int d : all_directions) {
        const Cell lower = brick->corner(bit), upper = lower + offset(d);
        if (!(brick->edges[d] >> bit & 1)) continue;
        ++found;
        EXPECT_NE(plain.inside(lower), plain.inside(upper));
        const CornerRef end = corner_at(*brick, bit, d);
        EXPECT_TRUE((end.brick.corner(end.bit) == upper).all());
        EXPECT_EQ(end.value(), lattice.on_boundary(upper) ? 0 : field(lattice.position(upper)));
      }
  for_each_cell(lattice, [&](const Cell& corner) {
    for (const int d : all_directions) expected += plain.inside(corner) != plain.inside(corner + offset(d));
  });
  EXPECT_EQ(found, expected);
}

TEST(CellTracer, GivesEdgesInTheDirectionsAskedForOnly) {
  const Implicit field = sphere(0.8);
  LevelSampler sampler(field, 0);
  CellTracer tracer(lattice, sampler);
  for_each_cell(lattice, [&](const Cell& cell) { tracer.add(cell); });
  tracer.run({});
  for (const Brick* brick : tracer.finish(axis_directions))
    for (const int d : {3, 5, 6, 7}) EXPECT_EQ(brick->edges[d], 0U);
}

// More bricks in one wave than are sampled in one batch. Inside are single corners: each has eight cells around it.
TEST(CellTracer, TakesAsManyCellsAtOnceAsThereAre) {
  const CellLattice large{Point<3>::Zero(), Point<3>::Ones(), Cell::Constant(200)};
  const auto is_start = [](const Cell& c) { return c[0] % 16 == 4 && c[1] % 8 == 5 && c[2] % 8 == 5; };
  const Implicit corners(
      [&](const Point<3>& p, Point<3>&) {
        const Cell c = p.array().round().cast<int>();
        return is_start(c) && c.sum() % 3 == 0 ? 1.0 : -1.0;
      },
      cube(1));
  LevelSampler sampler(corners, 0);
  CellTracer tracer(large, sampler);
  Index added = 0, inside = 0;
  for (int z = 5; z < 190; z += 8)
    for (int y = 5; y < 190; y += 8)
      for (int x = 4; x < 190; x += 16) {
        tracer.add({x, y, z});
        ++added;
        inside += (x + y + z) % 3 == 0;
      }
  tracer.run({});
  EXPECT_GT(added, 4096);
  EXPECT_EQ(tracer.active_cells(), 8 * inside);
  EXPECT_EQ(sampler.value_count(), 27 * inside + 8 * (added - inside));
}

TEST(CellTracer, ReportsAGrowingShareBelowFourFifths) {
  const Implicit field = sphere(0.8);
  LevelSampler sampler(field, 0);
  CellTracer tracer(lattice, sampler);
  tracer.add(lattice.cell_at(off_center + Point<3>(0.8, 0, 0)));
  std::vector<double> fractions;
  tracer.run([&](std::string_view stage, double fraction) {
    EXPECT_EQ(stage, "polygonize");
    fractions.push_back(fraction);
    return true;
  });
  EXPECT_EQ(static_cast<Index>(fractions.size()), tracer.waves());
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
  EXPECT_GT(fractions.front(), 0);
  // Taken for the share of a surface with as many cells as the sides of the lattice.
  const auto active = static_cast<double>(tracer.active_cells());
  EXPECT_NEAR(fractions.back(), 0.8 * active / (active + 2 * (17 * 21 + 21 * 9 + 9 * 17)), 1e-12);
}

}  // namespace
}  // namespace csrbf::polygonization::cell_tracer_test
