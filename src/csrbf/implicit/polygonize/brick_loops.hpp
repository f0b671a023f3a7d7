#pragma once

#include "csrbf/implicit/polygonize/brick_grid.hpp"
#include "csrbf/implicit/polygonize/cell_loops.hpp"

#include <bit>

namespace csrbf::polygonization {

/// The loops of an active cell; `inside` are the inside_corners of its brick.
std::span<const CellLoop> loops_of_cell(const Brick& brick, const Octet& inside, int cell);

/// Calls visit(cell, loop) for the loops of all active cells of a brick.
template <class Visit>
void for_each_loop(const Brick& brick, Visit&& visit) {
  if (brick.active == 0) return;
  const Octet inside = inside_corners(brick);
  for (Mask left = brick.active; left != 0; left &= left - 1) {
    const int cell = std::countr_zero(left);
    for (const CellLoop& loop : loops_of_cell(brick, inside, cell)) visit(cell, loop);
  }
}

}  // namespace csrbf::polygonization
