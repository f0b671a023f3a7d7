#pragma once

#include "csrbf/implicit/polygonize/brick_grid.hpp"

#include <bit>

namespace csrbf::polygonization {

/// Corner c of a cell lies at the offset (c & 1, c >> 1 & 1, c >> 2 & 1).
/// An edge runs from its lower corner to the corner above along its axis.
struct CellEdge {
  int axis;
  int corner;
};

/// Edges 4 a ... 4 a + 3 run along axis a.
inline constexpr std::array<CellEdge, 12> cell_edges{
    {{0, 0}, {0, 2}, {0, 4}, {0, 6}, {1, 0}, {1, 1}, {1, 4}, {1, 5}, {2, 0}, {2, 1}, {2, 2}, {2, 3}}};

/// A closed curve in which the surface meets the faces of a cell, counter-clockwise seen from outside the solid.
struct CellLoop {
  int size = 0;                            ///< 3 ... 12
  std::array<std::uint8_t, 12> edges{};    ///< the edges it passes
  std::array<std::uint16_t, 12> chords{};  ///< bit j of entry i: corners i and j of the loop may be joined
  bool triangulable = false;               ///< whether such chords triangulate it; otherwise it needs a vertex inside

  [[nodiscard]] int triangles() const { return triangulable ? size - 2 : size; }
};

/// Faces (bit 2 axis + side) on which corners alternate between inside and outside. Bit c of `inside`: corner c.
unsigned ambiguous_faces(unsigned inside);

/// The ambiguous faces on which the bilinear interpolant joins the two inside corners (the asymptotic decider, Nielson
/// and Hamann 1991). Depends only on the four values of a face, bit for bit, so that both cells agree.
unsigned joined_faces(unsigned inside, const std::array<double, 8>& value);

/// The loops of a cell. The cut of a face depends only on its own corner values, so the loops of neighbouring cells
/// match.
std::span<const CellLoop> cell_loops(unsigned inside, unsigned joined);

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

/// Three corners of a loop.
using LoopTriangle = std::array<std::uint8_t, 3>;

/// Triangulates a triangulable loop through the given points by the permitted chords with the smallest sum of squared
/// lengths; writes triangles() triangles. A chord is permitted if its ends are not on one face of the cell: otherwise
/// it could be a chord of the neighbour as well, and the edge would have four triangles.
void triangulate(const CellLoop& loop, const std::array<Point<3>, 12>& points, std::array<LoopTriangle, 12>& triangles);

}  // namespace csrbf::polygonization
