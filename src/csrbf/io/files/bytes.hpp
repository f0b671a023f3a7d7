#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <type_traits>

namespace csrbf {

/// The scalar stored at `bytes` (no alignment needed) in the given byte order.
template <class T>
T load_scalar(const char* bytes, std::endian order = std::endian::little) {
  std::array<char, sizeof(T)> raw;
  std::memcpy(raw.data(), bytes, sizeof(T));
  if (order != std::endian::native) std::reverse(raw.begin(), raw.end());
  return std::bit_cast<T>(raw);
}

/// Stores a scalar at `bytes` (no alignment needed) in little-endian order.
template <class T>
void store_scalar(char* bytes, T value) {
  auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
  if (std::endian::native != std::endian::little) std::reverse(raw.begin(), raw.end());
  std::memcpy(bytes, raw.data(), raw.size());
}

/// Appends a scalar to `out` in little-endian order.
template <class T>
void append_scalar(std::string& out, T value) {
  std::array<char, sizeof(T)> raw;
  store_scalar(raw.data(), value);
  out.append(raw.data(), raw.size());
}

/// Converts a value to a scalar type of a file: integers are rounded and clamped, NaN becomes 0; a float that cannot
/// hold the value becomes infinite.
template <class T>
T narrow_scalar(double value) {
  constexpr auto lowest = static_cast<double>(std::numeric_limits<T>::lowest());
  constexpr auto highest = static_cast<double>(std::numeric_limits<T>::max());
  if constexpr (std::is_floating_point_v<T>) {
    constexpr T infinity = std::numeric_limits<T>::infinity();
    if (value > highest) return infinity;
    return value < lowest ? -infinity : static_cast<T>(value);
  } else {
    if (std::isnan(value)) return 0;
    // Converted to double, the largest 64-bit integer is one too large to convert back.
    if (value >= highest) return std::numeric_limits<T>::max();
    return static_cast<T>(std::nearbyint(std::max(value, lowest)));
  }
}

}  // namespace csrbf
