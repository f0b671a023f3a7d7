#pragma once

#include <array>
#include <cstdint>

namespace csrbf {

/// Every byte with Dim - 1 zeros between its bits.
template <int Dim>
inline constexpr std::array<std::uint64_t, 256> spread_bytes = [] {
  std::array<std::uint64_t, 256> table{};
  for (std::size_t byte = 0; byte < table.size(); ++byte)
    for (int bit = 0; bit < 8 && bit * Dim < 64; ++bit) table[byte] |= std::uint64_t{byte >> bit & 1U} << (bit * Dim);
  return table;
}();

/// The lowest `bits` bits of the number of a cell along each axis, interleaved, those of the first axis lowest: its
/// place along the Morton (Z-order) curve. Needs Dim * bits <= 64.
template <int Dim>
std::uint64_t morton_code(const std::array<std::uint64_t, Dim>& cell, int bits) {
  std::uint64_t code = 0;
  for (int axis = 0; axis < Dim; ++axis)
    for (int byte = 0; 8 * byte < bits; ++byte)
      code |= spread_bytes<Dim>[cell[axis] >> (8 * byte) & 255U] << (8 * byte * Dim + axis);
  return code;
}

}  // namespace csrbf
