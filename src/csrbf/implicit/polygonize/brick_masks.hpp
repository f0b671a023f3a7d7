#pragma once

#include <array>
#include <cstdint>

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

}  // namespace csrbf::polygonization
