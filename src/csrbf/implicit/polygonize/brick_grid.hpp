#pragma once

#include "csrbf/core/types.hpp"

#include <memory>
#include <vector>

namespace csrbf::polygonization {

/// One bit for every cell, or for every corner, of a brick of 4 x 4 x 4: bit x + 4 y + 16 z.
using Mask = std::uint64_t;

inline constexpr int brick_side = 4;

/// Distance of two bits that are neighbours along `axis`.
constexpr int bit_stride(int axis) {
  return 1 << (2 * axis);
}

/// The bits with coordinate 0 along `axis`.
constexpr Mask first_layer(int axis) {
  constexpr std::array<Mask, 3> layer{0x1111111111111111U, 0x000F000F000F000FU, 0x000000000000FFFFU};
  return layer[axis];
}

/// The bits with coordinate 3 along `axis`.
constexpr Mask last_layer(int axis) {
  return first_layer(axis) << (3 * bit_stride(axis));
}

/// `mask` moved by one along `axis`: what stays in the brick, and what enters the brick above.
constexpr Mask moved_up(Mask mask, int axis) {
  return (mask & ~last_layer(axis)) << bit_stride(axis);
}
constexpr Mask carried_up(Mask mask, int axis) {
  return (mask & last_layer(axis)) >> (3 * bit_stride(axis));
}

/// `mask` moved by minus one along `axis`: what stays in the brick, and what enters the brick below.
constexpr Mask moved_down(Mask mask, int axis) {
  return (mask & ~first_layer(axis)) >> bit_stride(axis);
}
constexpr Mask carried_down(Mask mask, int axis) {
  return (mask & first_layer(axis)) << (3 * bit_stride(axis));
}

/// Eight masks, numbered by an offset d: dx = d & 1, dy = d >> 1 & 1, dz = d >> 2 & 1. Either those of a brick and its
/// seven upper neighbours, or those of one brick for each of the eight corners of its cells.
using Octet = std::array<Mask, 8>;

/// Adds to every set bit the next one along `axis`, over a brick and its upper neighbours.
constexpr void dilate(Octet& bricks, int axis) {
  for (int k = 0; k < 8; ++k) {
    if (k >> axis & 1) continue;
    bricks[k | 1 << axis] |= carried_up(bricks[k], axis);
    bricks[k] |= moved_up(bricks[k], axis);
  }
}

/// From the corner masks of a brick and its upper neighbours: mask d holds in bit b the corner at offset d of cell b.
constexpr Octet corners_of_cells(Octet masks) {
  for (int axis = 0; axis < 3; ++axis) {
    for (int k = 0; k < 8; ++k) {
      if (k >> axis & 1) continue;
      Mask& upper = masks[k | 1 << axis];
      upper = moved_down(masks[k], axis) | carried_down(upper, axis);
    }
  }
  return masks;
}

/// Cells whose eight corners are not all on the same side.
constexpr Mask mixed_cells(const Octet& inside) {
  Mask any = 0;
  Mask all = ~Mask{0};
  for (const Mask corner : inside) {
    any |= corner;
    all &= corner;
  }
  return any & ~all;
}

/// Cells whose face on the given side (0 = lower, 1 = upper) along `axis` has corners on both sides of the surface.
constexpr Mask mixed_faces(const Octet& inside, int axis, int side) {
  Mask any = 0;
  Mask all = ~Mask{0};
  for (int d = 0; d < 8; ++d) {
    if ((d >> axis & 1) != side) continue;
    any |= inside[d];
    all &= inside[d];
  }
  return any & ~all;
}

/// Integer coordinates of a corner, of a cell (those of its lowest corner) or of a brick.
using Cell = Eigen::Array3i;

/// Edges run from their lower corner to the one at the offset (d & 1, d >> 1 & 1, d >> 2 & 1); d is their direction.
inline constexpr std::array<int, 3> axis_directions{1, 2, 4};
inline constexpr std::array<int, 7> all_directions{1, 2, 3, 4, 5, 6, 7};  ///< also diagonals of faces and cells

/// The offset of direction d.
inline Cell offset(int d) {
  return {d & 1, d >> 1 & 1, d >> 2 & 1};
}

/// Least distance of a vertex from the ends of its edge, as a share of the edge, so that no two vertices coincide.
/// Chosen by hand; larger: misplaced vertices, smaller: thinner triangles.
inline constexpr double edge_margin = 1e-3;

/// A regular lattice of box-shaped cells. The outermost corners count as outside whatever the field's value there, so
/// that every surface is closed within the lattice.
struct CellLattice {
  Point<3> origin;   ///< position of corner (0, 0, 0)
  Point<3> spacing;  ///< edge lengths of a cell
  Cell cells;        ///< number of cells along each axis; corners run from 0 to cells inclusive

  [[nodiscard]] Point<3> position(const Cell& corner) const {
    return origin + spacing.cwiseProduct(corner.matrix().cast<double>());
  }
  /// The box of the corners that are sampled, plus a small margin: the outer sides of the caps.
  [[nodiscard]] Box<3> capped_box() const {
    const Point<3> beyond = edge_margin * spacing;
    return {position(Cell::Ones()) - beyond, position(cells - 1) + beyond};
  }
  [[nodiscard]] bool on_boundary(const Cell& corner) const { return (corner <= 0).any() || (corner >= cells).any(); }
  /// The cell that contains p, or the nearest one that does not touch the boundary.
  [[nodiscard]] Cell cell_at(const Point<3>& p) const;
};

/// The cells with first <= cell < last along every axis.
struct CellRange {
  Cell first = Cell::Zero();
  Cell last = Cell::Zero();

  [[nodiscard]] bool contains(const Cell& cell) const { return (cell >= first).all() && (cell < last).all(); }
};

/// Largest number of cells along an axis: coordinates fit Morton keys of 3 x 21 bits.
inline constexpr int max_cells = 1 << 20;

/// Cubes of side `size` that fill a box, and four more on every side, for the box may be that of samples beside the
/// surface; another layer holds the caps. Throws InvalidInput for 2^20 cells along a side.
CellLattice lattice_around(const Box<3>& box, double size);

/// Cells of about that size, as close to cubes as fill the box exactly; another layer holds the caps. Throws the same.
CellLattice lattice_in(const Box<3>& box, double size);

/// Position of a cell or brick along a Morton curve; coordinates below 2^21.
std::uint64_t morton_key(const Cell& cell);

/// 4^3 corners and the 4^3 cells that have them as lowest corners. The data used in a wave share one cache line.
struct alignas(64) Brick {
  std::uint64_t key = 0;          ///< Morton key of the brick's coordinates
  Mask inside = 0;                ///< known corners with value >= 0
  Mask known = 0;                 ///< corners whose value is known
  Mask needed = 0;                ///< corners to be sampled in this wave
  Mask queued = 0;                ///< cells of the next wave
  Mask pending = 0;               ///< cells of this wave
  Mask visited = 0;               ///< cells of earlier waves
  Mask active = 0;                ///< visited cells that the surface crosses
  std::array<Brick*, 8> upper{};  ///< itself and the upper neighbours, null if unknown
  std::array<Brick*, 3> lower{};  ///< lower face neighbours, null if unknown
  Cell first = Cell::Zero();      ///< its lowest corner
  std::array<int, 8> vertex{};    ///< number of the first vertex on an edge in each direction
  Octet edges{};                  ///< crossed edges of active cells, by direction, at their lower corners
  Mask grown = 0;                 ///< see weak_bridges
  Mask moved = 0;                 ///< corners whose side is not that of the field
  std::array<double, 64> value;   ///< field minus level at the known corners; 0 on the boundary of the lattice

  [[nodiscard]] Cell corner(int bit) const { return first + Cell(bit & 3, bit >> 2 & 3, bit >> 4); }
};

/// The bit of a corner or cell in its brick.
inline int bit_of(const Cell& cell) {
  return (cell[0] & 3) | (cell[1] & 3) << 2 | (cell[2] & 3) << 4;
}

void sort_along_curve(std::vector<Brick*>& bricks);

/// A corner and the brick that holds it.
struct CornerRef {
  const Brick& brick;
  int bit;

  [[nodiscard]] double value() const { return brick.value[bit]; }
};

/// The corner at the offset (d & 1, d >> 1 & 1, d >> 2 & 1) from corner `bit` of a brick whose neighbours there are
/// known.
inline CornerRef corner_at(const Brick& brick, int bit, int d) {
  const int x = (bit & 3) + (d & 1);
  const int y = (bit >> 2 & 3) + (d >> 1 & 1);
  const int z = (bit >> 4) + (d >> 2);
  return {*brick.upper[(x >> 2) | (y >> 2) << 1 | (z >> 2) << 2], (x & 3) | (y & 3) << 2 | (z & 3) << 4};
}

/// The inside masks for the eight corners of the cells of a brick. Valid for visited cells.
Octet inside_corners(const Brick& brick);

/// The bricks near the surface, found by coordinates. Addresses never change. Not thread safe.
class BrickGrid {
 public:
  explicit BrickGrid(const CellLattice& lattice) : lattice_(lattice) { grow(); }

  [[nodiscard]] const CellLattice& lattice() const { return lattice_; }

  /// The brick that holds a corner or cell, or null.
  [[nodiscard]] Brick* find(const Cell& cell) const { return slots_[slot_of(morton_key(cell / brick_side))].brick; }

  /// The same, created if necessary.
  Brick& at(const Cell& cell);

  /// The neighbour at offset k in {0, 1}^3, or below along an axis, created if necessary.
  Brick& upper(Brick& brick, int k);
  Brick& lower(Brick& brick, int axis);

  /// All bricks along the Morton curve.
  [[nodiscard]] std::vector<Brick*> sorted() const;

 private:
  struct Slot {
    std::uint64_t key = 0;
    Brick* brick = nullptr;
  };

  [[nodiscard]] std::size_t slot_of(std::uint64_t key) const;
  Brick& add(std::uint64_t key, std::size_t slot, const Cell& coordinates);
  void grow();

  static constexpr std::size_t chunk_size = 256;  // bricks allocated at a time

  CellLattice lattice_;
  std::vector<std::unique_ptr<Brick[]>> chunks_;
  std::size_t size_ = 0;
  std::vector<Slot> slots_;  // open addressing, a power of two, at most half full
  int hash_shift_ = 0;
};

}  // namespace csrbf::polygonization
