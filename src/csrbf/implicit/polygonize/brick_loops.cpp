#include "csrbf/implicit/polygonize/brick_loops.hpp"

namespace csrbf::polygonization {

std::span<const CellLoop> loops_of_cell(const Brick& brick, const Octet& inside_masks, int cell) {
  unsigned inside = 0;
  for (int c = 0; c < 8; ++c) inside |= static_cast<unsigned>(inside_masks[c] >> cell & 1) << c;
  if (ambiguous_faces(inside) == 0) return cell_loops(inside, 0);
  std::array<double, 8> value;
  for (int c = 0; c < 8; ++c) value[c] = corner_at(brick, cell, c).value();
  return cell_loops(inside, joined_faces(inside, value));
}

}  // namespace csrbf::polygonization
