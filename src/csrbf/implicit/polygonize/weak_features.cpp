#include "csrbf/implicit/polygonize/weak_features.hpp"

#include "csrbf/core/disjoint_sets.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/implicit/polygonize/cell_loops.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <optional>
#include <queue>
#include <unordered_map>

namespace csrbf::polygonization {
namespace {

// The corners around one, and itself: x + 3 y + 9 z.
constexpr int around = 27, middle = 13;
constexpr Index bricks_per_task = 256;  // large enough to hide the cost of a task
using Around = std::array<double, around>;

constexpr std::array<int, 3> direction(int k) {
  return {k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1};
}

constexpr bool across_face(int k) {
  const auto [x, y, z] = direction(k);
  return x * x + y * y + z * z == 1;
}

// Of the offset (d & 1, d >> 1 & 1, d >> 2 & 1) from the lowest of them.
constexpr int position(int d) {
  return (d & 1) + 3 * (d >> 1 & 1) + 9 * (d >> 2);
}

// Euler characteristic of that part of the surface which depends on the corner in the middle: crossed edges are its
// vertices, cuts of faces its edges, loops of cells its faces. Positive values are inside.
int euler_around(const Around& value) {
  int vertices = 0, cut_ends = 0, loops = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (const int step : {-1, 1})
      vertices += (value[middle] >= 0) != (value[middle + step * position(1 << axis)] >= 0) ? 1 : 0;
  for (int lowest = 0; lowest < 8; ++lowest) {
    std::array<double, 8> corner{};
    unsigned inside = 0;
    for (int c = 0; c < 8; ++c) {
      corner[c] = value[position(lowest) + position(c)];
      inside |= static_cast<unsigned>(corner[c] >= 0) << c;
    }
    const unsigned joined = ambiguous_faces(inside) == 0 ? 0 : joined_faces(inside, corner);
    loops += static_cast<int>(cell_loops(inside, joined).size());
    const int own = 7 - lowest;
    for (int axis = 0; axis < 3; ++axis) {  // the faces of the cell at that corner
      const int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3;
      const std::array<int, 5> ring{own, own ^ u, own ^ u ^ v, own ^ v, own};
      for (int i = 0; i < 4; ++i) cut_ends += (inside >> ring[i] ^ inside >> ring[i + 1]) & 1;
    }
  }
  return vertices - cut_ends / 4 + loops;  // two cells have a face, two ends a cut
}

// Of the cubes around one in the middle, by bits.
using Cubes = std::uint32_t;

// What cubes have in common with the one in the middle, as bits: faces, edges and vertices by their directions.
auto closure_tables() {
  std::array<std::array<Cubes, 512>, 3> tables{};
  for (int third = 0; third < 3; ++third)
    for (Cubes cubes = 0; cubes < 512; ++cubes)
      for (int bit = 0; bit < 9; ++bit) {
        const auto d = direction(9 * third + bit);
        if ((cubes >> bit & 1) == 0 || 9 * third + bit == middle) continue;
        for (int k = 0; k < around; ++k) {
          const auto e = direction(k);
          bool bounds = true;
          for (int axis = 0; axis < 3; ++axis) bounds = bounds && (d[axis] == 0 || d[axis] == e[axis]);
          if (bounds) tables[third][cubes] |= Cubes{1} << k;
        }
      }
  return tables;
}

constexpr Cubes parts_of_dimension(int dimension) {
  Cubes parts = 0;
  for (int k = 0; k < around; ++k) {
    const auto [x, y, z] = direction(k);
    if (x * x + y * y + z * z == 3 - dimension) parts |= Cubes{1} << k;
  }
  return parts;
}

// Euler characteristic of what cubes have in common with the one in the middle.
int euler_of_contact(Cubes cubes) {
  static const auto closure = closure_tables();
  const Cubes parts = closure[0][cubes & 511] | closure[1][cubes >> 9 & 511] | closure[2][cubes >> 18];
  constexpr Cubes vertices = parts_of_dimension(0), edges = parts_of_dimension(1), faces = parts_of_dimension(2);
  return std::popcount(parts & vertices) - std::popcount(parts & edges) + std::popcount(parts & faces);
}

// The values at the corners of a brick and around it, from one below its first: x + 6 y + 36 z; NaN where not known.
constexpr int padded_side = brick_side + 2;
using Padded = std::array<double, padded_side * padded_side * padded_side>;

Padded values_of(const std::array<Brick*, around>& bricks) {
  Padded values;
  for (int z = 0, i = 0; z < padded_side; ++z)
    for (int y = 0; y < padded_side; ++y)
      for (int x = 0; x < padded_side; ++x, ++i) {
        const Brick* holder = bricks[(x + 3) / 4 + 3 * ((y + 3) / 4) + 9 * ((z + 3) / 4)];
        const int bit = bit_of(Cell(x + 3, y + 3, z + 3));
        const bool known = holder != nullptr && (holder->known >> bit & 1) != 0;
        values[i] = known ? holder->value[bit] : std::numeric_limits<double>::quiet_NaN();
      }
  return values;
}

// Whether the topology changes where the level passes a corner; whichever corners across faces and edges of cells the
// surface joins.
bool is_critical(const Padded& values, int bit) {
  const int at = (bit & 3) + 1 + padded_side * ((bit >> 2 & 3) + 1 + padded_side * ((bit >> 4) + 1));
  const double own = std::abs(values[at]), sign = std::signbit(values[at]) ? -1 : 1;
  Cubes higher = 0;
  for (int k = 0; k < around; ++k) {
    if (k == middle) continue;
    const auto [x, y, z] = direction(k);
    const double other = sign * values[at + x + padded_side * (y + padded_side * z)];
    if (!(other < own || (other == own && k < middle))) higher |= Cubes{1} << k;
  }
  constexpr Cubes all = (Cubes{1} << around) - 1 - (Cubes{1} << middle);
  return euler_of_contact(higher) != 1 || euler_of_contact(all & ~higher) != 1;
}

// The bricks around one, and itself; null where there is none.
std::array<Brick*, around> bricks_around(const BrickGrid& grid, const Brick& brick) {
  std::array<Brick*, around> bricks{};
  for (int k = 0; k < around; ++k) {
    const auto [x, y, z] = direction(k);
    const Cell first = brick.first + brick_side * Cell(x, y, z);
    if ((first >= 0).all()) bricks[k] = grid.find(first);
  }
  return bricks;
}

// The corners nearer to the level than the persistence, but for the ends of the lattice.
Mask near_level(const CellLattice& lattice, const Brick& brick, double persistence) {
  const bool at_end = lattice.on_boundary(brick.first) || lattice.on_boundary(brick.first + brick_side);
  Mask near = 0;
  for (Mask left = brick.known; left != 0; left &= left - 1) {
    const int bit = std::countr_zero(left);
    if (std::abs(brick.value[bit]) < persistence && !(at_end && lattice.on_boundary(brick.corner(bit))))
      near |= Mask{1} << bit;
  }
  return near;
}

// Corners that are left when a side has grown.
struct Group {
  std::vector<BrickCorner> corners;
  int euler = 0;          // by how much they raise the Euler characteristic
  bool at_level = false;  // next to the other side: not only a bubble
};

// One side of the surface.
class Side {
 public:
  Side(const BrickGrid& grid, const std::vector<Brick*>& doubtful, bool inside, double persistence)
      : grid_(grid), bricks_(grid.sorted()), inside_(inside), persistence_(persistence) {
    for (Brick* brick : bricks_) brick->grown = mine(*brick);
    for (Brick* brick : doubtful) {
      const Mask near = mine(*brick) & near_level(grid.lattice(), *brick, persistence);
      brick->grown &= ~near;
      for (Mask left = near; left != 0; left &= left - 1) band_.push_back({brick, std::countr_zero(left)});
    }
  }

  // Adds corners while the topology stays the same; those far from the level first.
  void grow() {
    const auto later = [](const BrickCorner& a, const BrickCorner& b) {
      if (distance(a) != distance(b)) return distance(a) < distance(b);
      return std::pair(a.brick->key, a.bit) > std::pair(b.brick->key, b.bit);
    };
    std::priority_queue<BrickCorner, std::vector<BrickCorner>, decltype(later)> queue(later, band_);
    while (!queue.empty()) {
      const BrickCorner corner = queue.top();
      queue.pop();
      if (has_grown(corner) || !touches(corner) || euler_of_adding(corner) != 0) continue;
      add(corner);
      for_each_around(corner, [&](int, const BrickCorner* next) {
        if (next != nullptr && waits(*next) && !later(*next, corner)) queue.push(*next);
      });
    }
  }

  // Groups that lower the Euler characteristic; all others are added.
  std::vector<Group> groups() {
    std::vector<Group> result;
    for (const BrickCorner& start : band_) {
      if (has_grown(start)) continue;
      Group group = group_of(start);
      if (group.euler < 0 && group.at_level) result.push_back(std::move(group));
    }
    for (const Group& group : result)
      for (const BrickCorner& c : group.corners) c.brick->grown &= ~(Mask{1} << c.bit);
    return result;
  }

  // Finds the parts of what has grown, by ways along the axes.
  void find_parts() {
    for (std::size_t b = 0; b < bricks_.size(); ++b) number_.emplace(bricks_[b], static_cast<std::uint32_t>(b));
    parts_ = DisjointSets(64 * bricks_.size());
    for (std::uint32_t b = 0; b < bricks_.size(); ++b)
      for (int axis = 0; axis < 3; ++axis) {
        const Brick& brick = *bricks_[b];
        const Brick* above = brick.upper[1 << axis];
        const std::uint32_t stride = bit_stride(axis);
        for (Mask left = brick.grown & moved_down(brick.grown, axis); left != 0; left &= left - 1) {
          const std::uint32_t corner = 64 * b + std::countr_zero(left);
          parts_.unite(corner, corner + stride);
        }
        if (above == nullptr) continue;
        const std::uint32_t first = 64 * number_.at(above) - 3 * stride;
        for (Mask left = brick.grown & carried_down(above->grown, axis); left != 0; left &= left - 1)
          parts_.unite(64 * b + std::countr_zero(left), first + std::countr_zero(left));
      }
  }

  // Whether all corners around a group are of the same part.
  [[nodiscard]] bool closes_ring(const Group& group) {
    std::optional<std::uint32_t> part;
    bool same = true;
    for (const BrickCorner& corner : group.corners)
      for_each_around(corner, [&](int, const BrickCorner* next) {
        if (next == nullptr || !has_grown(*next)) return;
        const std::uint32_t other = parts_.find(id(*next));
        same = same && part.value_or(other) == other;
        part = other;
      });
    return same;
  }

 private:
  [[nodiscard]] Mask mine(const Brick& brick) const { return brick.known & (inside_ ? brick.inside : ~brick.inside); }
  [[nodiscard]] bool is_mine(const BrickCorner& c) const { return (mine(*c.brick) >> c.bit & 1) != 0; }
  // Not 0, so that a value has a sign.
  [[nodiscard]] static double distance(const BrickCorner& c) {
    return std::max(std::abs(c.brick->value[c.bit]), std::numeric_limits<double>::min());
  }
  [[nodiscard]] static bool has_grown(const BrickCorner& c) { return (c.brick->grown >> c.bit & 1) != 0; }
  [[nodiscard]] bool waits(const BrickCorner& c) const { return is_mine(c) && !has_grown(c); }
  static void add(const BrickCorner& c) { c.brick->grown |= Mask{1} << c.bit; }
  [[nodiscard]] std::uint32_t id(const BrickCorner& c) const {
    return 64 * number_.at(c.brick) + static_cast<std::uint32_t>(c.bit);
  }

  // Calls visit(k, corner) for the corners around one, with null for those that are not known.
  template <class Visit>
  void for_each_around(const BrickCorner& c, const Visit& visit) const {
    const int x = c.bit & 3, y = c.bit >> 2 & 3, z = c.bit >> 4;
    for (int k = 0; k < around; ++k) {
      if (k == middle) continue;
      const auto [dx, dy, dz] = direction(k);
      const bool within = ((x + dx) | (y + dy) | (z + dz)) >> 2 == 0;  // no bit of 4 or of a negative number
      Brick* brick = within ? c.brick : grid_.find(c.brick->first + Cell(x + dx, y + dy, z + dz));
      const BrickCorner corner{brick, bit_of(Cell(x + dx, y + dy, z + dz))};
      visit(k, brick != nullptr && (brick->known >> corner.bit & 1) != 0 ? &corner : nullptr);
    }
  }

  // Whether there is something to grow from. Corners that are not known have the same side as those next to them: no
  // cell around them is crossed.
  [[nodiscard]] bool touches(const BrickCorner& corner) const {
    bool result = false;
    for_each_around(corner, [&](int, const BrickCorner* c) { result = result || c == nullptr || has_grown(*c); });
    return result;
  }

  // How much the Euler characteristic rises with the corner.
  [[nodiscard]] int euler_of_adding(const BrickCorner& corner) const {
    const double sign = inside_ ? 1 : -1;
    Around values;
    for_each_around(corner, [&](int k, const BrickCorner* c) {
      const bool grown = c == nullptr || has_grown(*c);
      const double size = c == nullptr || waits(*c) ? persistence_ : distance(*c);
      values[k] = grown ? sign * size : -sign * size;
    });
    values[middle] = -sign * persistence_;
    const int before = euler_around(values);
    values[middle] = sign * distance(corner);
    return euler_around(values) - before;
  }

  // Adds the corners that wait and hang together with one.
  Group group_of(const BrickCorner& start) {
    Group group;
    const auto take = [&](const BrickCorner& corner) {
      group.euler += euler_of_adding(corner);
      add(corner);
      group.corners.push_back(corner);
    };
    take(start);
    for (std::size_t i = 0; i < group.corners.size(); ++i) {
      const BrickCorner corner = group.corners[i];
      for_each_around(corner, [&](int k, const BrickCorner* next) {
        if (next == nullptr) return;
        if (waits(*next)) take(*next);
        group.at_level = group.at_level || (across_face(k) && !is_mine(*next));
      });
    }
    return group;
  }

  const BrickGrid& grid_;
  std::vector<Brick*> bricks_;
  bool inside_;
  double persistence_;
  std::vector<BrickCorner> band_;  // nearer to the level than the persistence, where there are critical corners
  std::unordered_map<const Brick*, std::uint32_t> number_;
  DisjointSets parts_{0};
};

}  // namespace

std::vector<Brick*> doubtful_bricks(const BrickGrid& grid, double persistence) {
  const std::vector<Brick*> bricks = grid.sorted();
  std::vector<char> critical(bricks.size());
  parallel_for(std::ssize(bricks), bricks_per_task, [&](Index begin, Index end) {
    for (Index b = begin; b < end; ++b) {
      const Mask near = near_level(grid.lattice(), *bricks[b], persistence);
      if (near == 0) continue;
      const Padded values = values_of(bricks_around(grid, *bricks[b]));
      for (Mask left = near; left != 0 && critical[b] == 0; left &= left - 1)
        critical[b] = is_critical(values, std::countr_zero(left)) ? 1 : 0;
    }
  });
  std::vector<Brick*> doubtful;
  for (std::size_t b = 0; b < bricks.size(); ++b)
    if (critical[b] != 0)
      for (Brick* brick : bricks_around(grid, *bricks[b]))
        if (brick != nullptr) doubtful.push_back(brick);
  sort_along_curve(doubtful);
  doubtful.erase(std::unique(doubtful.begin(), doubtful.end()), doubtful.end());
  return doubtful;
}

std::vector<std::vector<BrickCorner>> weak_bridges(const BrickGrid& grid, const std::vector<Brick*>& doubtful,
                                                   bool inside, double persistence) {
  std::vector<std::vector<BrickCorner>> bridges;
  if (doubtful.empty()) return bridges;
  Side side(grid, doubtful, inside, persistence);
  side.grow();
  std::vector<Group> groups = side.groups();
  if (groups.empty()) return bridges;
  side.find_parts();
  for (Group& group : groups)
    if (side.closes_ring(group)) bridges.push_back(std::move(group.corners));
  return bridges;
}

}  // namespace csrbf::polygonization
