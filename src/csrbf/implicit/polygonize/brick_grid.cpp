#include "csrbf/implicit/polygonize/brick_grid.hpp"

#include "csrbf/core/error.hpp"

#include <bit>

namespace csrbf::polygonization {
namespace {

constexpr int default_margin = 4;  // cells around the box; chosen by hand
constexpr double rounding = 1e-9;  // cells: a side that exceeds a whole number of cells by less is not enlarged

Eigen::Array3d cells_in(const Box<3>& box, double size) {
  const Eigen::Array3d cells = box.extent().array() / size;
  require(cells.maxCoeff() < max_cells - 10, "polygonize", "bounds / cell size", cells.maxCoeff(),
          "must be below 2^20 cells; shrink the bounds or lower the resolution");
  return cells;
}

// Inserts two zero bits after each of the lowest 21 bits.
std::uint64_t spread_bits(std::uint64_t x) {
  x = (x | x << 32) & 0x001F00000000FFFFU;
  x = (x | x << 16) & 0x001F0000FF0000FFU;
  x = (x | x << 8) & 0x100F00F00F00F00FU;
  x = (x | x << 4) & 0x10C30C30C30C30C3U;
  return (x | x << 2) & 0x1249249249249249U;
}

}  // namespace

CellLattice lattice_around(const Box<3>& box, double size) {
  CellLattice lattice;
  lattice.cells = (cells_in(box, size) - rounding).ceil().cast<int>() + 2 * default_margin + 2;
  lattice.spacing.setConstant(size);
  lattice.origin = box.center() - 0.5 * size * lattice.cells.matrix().cast<double>();
  return lattice;
}

CellLattice lattice_in(const Box<3>& box, double size) {
  const Cell inner = cells_in(box, size).round().cast<int>().max(1);
  CellLattice lattice;
  lattice.cells = inner + 2;
  lattice.spacing = box.extent().array() / inner.cast<double>();
  lattice.origin = box.lo - lattice.spacing;
  return lattice;
}

std::uint64_t morton_key(const Cell& cell) {
  return spread_bits(static_cast<std::uint64_t>(cell[0])) | spread_bits(static_cast<std::uint64_t>(cell[1])) << 1 |
         spread_bits(static_cast<std::uint64_t>(cell[2])) << 2;
}

Cell CellLattice::cell_at(const Point<3>& p) const {
  Cell cell;
  for (int axis = 0; axis < 3; ++axis)
    cell[axis] = static_cast<int>(std::clamp((p[axis] - origin[axis]) / spacing[axis], 1.0, cells[axis] - 2.0));
  return cell;
}

Octet inside_corners(const Brick& brick) {
  Octet inside;
  for (int k = 0; k < 8; ++k) inside[k] = brick.upper[k] != nullptr ? brick.upper[k]->inside : 0;
  return corners_of_cells(inside);
}

std::size_t BrickGrid::slot_of(std::uint64_t key) const {
  std::size_t slot = key * 0x9E3779B97F4A7C15U >> hash_shift_;
  while (slots_[slot].brick != nullptr && slots_[slot].key != key) slot = (slot + 1) & (slots_.size() - 1);
  return slot;
}

Brick& BrickGrid::at(const Cell& cell) {
  const Cell brick = cell / brick_side;
  const std::uint64_t key = morton_key(brick);
  const std::size_t slot = slot_of(key);
  return slots_[slot].brick != nullptr ? *slots_[slot].brick : add(key, slot, brick);
}

Brick& BrickGrid::upper(Brick& brick, int k) {
  if (brick.upper[k] == nullptr) {
    brick.upper[k] = &at(brick.first + brick_side * offset(k));
    if (std::has_single_bit(static_cast<unsigned>(k))) brick.upper[k]->lower[k / 2] = &brick;
  }
  return *brick.upper[k];
}

Brick& BrickGrid::lower(Brick& brick, int axis) {
  if (brick.lower[axis] == nullptr) {
    brick.lower[axis] = &at(brick.first - brick_side * offset(1 << axis));
    brick.lower[axis]->upper[1 << axis] = &brick;
  }
  return *brick.lower[axis];
}

std::vector<Brick*> BrickGrid::sorted() const {
  std::vector<Brick*> bricks(size_);
  for (std::size_t i = 0; i < size_; ++i) bricks[i] = &chunks_[i / chunk_size][i % chunk_size];
  sort_along_curve(bricks);
  return bricks;
}

void sort_along_curve(std::vector<Brick*>& bricks) {
  std::sort(bricks.begin(), bricks.end(), [](const Brick* a, const Brick* b) { return a->key < b->key; });
}

Brick& BrickGrid::add(std::uint64_t key, std::size_t slot, const Cell& coordinates) {
  if (size_ % chunk_size == 0) chunks_.emplace_back(new Brick[chunk_size]);  // values are uninitialised until known
  Brick& brick = chunks_.back()[size_++ % chunk_size];
  brick.key = key;
  brick.first = brick_side * coordinates;
  brick.upper[0] = &brick;
  if (lattice_.on_boundary(brick.first) || lattice_.on_boundary(brick.first + brick_side)) {
    for (int bit = 0; bit < 64; ++bit) {
      if (!lattice_.on_boundary(brick.corner(bit))) continue;
      brick.known |= Mask{1} << bit;
      brick.value[bit] = 0;
    }
  }
  slots_[slot] = {key, &brick};
  if (2 * size_ > slots_.size()) grow();
  return brick;
}

void BrickGrid::grow() {
  slots_.assign(std::max<std::size_t>(1024, 2 * slots_.size()), {});
  hash_shift_ = 64 - std::countr_zero(slots_.size());
  for (std::size_t i = 0; i < size_; ++i) {
    Brick& brick = chunks_[i / chunk_size][i % chunk_size];
    slots_[slot_of(brick.key)] = {brick.key, &brick};
  }
}

}  // namespace csrbf::polygonization
