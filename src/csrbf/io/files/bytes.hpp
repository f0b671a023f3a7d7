#pragma once

#include "csrbf/core/grid.hpp"
#include "csrbf/core/numbers/bit_cast.hpp"

#include <bit>
#include <cstring>
#include <optional>
#include <string_view>

namespace csrbf {

/// The scalar stored at `bytes` (no alignment needed) in the given byte order.
template <class T>
T load_scalar(const char* bytes, std::endian order = std::endian::little) {
  std::array<char, sizeof(T)> raw;
  std::memcpy(raw.data(), bytes, sizeof(T));
  if (order != std::endian::native) std::reverse(raw.begin(), raw.end());
  return bit_cast<T>(raw);
}

/// Stores a scalar at `bytes` (no alignment needed) in little-endian order.
template <class T>
void store_scalar(char* bytes, T value) {
  auto raw = bit_cast<std::array<char, sizeof(T)>>(value);
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

/// Calls action(T{}) with T the C++ type of the samples.
template <class Action>
decltype(auto) with_sample_type(SampleType type, Action action) {
  if (type == SampleType::uint8) return action(std::uint8_t{});
  if (type == SampleType::int8) return action(std::int8_t{});
  if (type == SampleType::uint16) return action(std::uint16_t{});
  if (type == SampleType::int16) return action(std::int16_t{});
  if (type == SampleType::uint32) return action(std::uint32_t{});
  if (type == SampleType::int32) return action(std::int32_t{});
  if (type == SampleType::uint64) return action(std::uint64_t{});
  if (type == SampleType::int64) return action(std::int64_t{});
  if (type == SampleType::float32) return action(float{});
  return action(double{});
}

/// A limit on numbers in files, lowered to what an index can hold on processors of 32 bits.
constexpr std::int64_t index_limit(std::int64_t limit) {
  return std::min(limit, static_cast<std::int64_t>(std::numeric_limits<Index>::max()));
}

/// Bytes of one sample.
inline std::size_t sample_size(SampleType type) {
  return with_sample_type(type, [](auto sample) { return sizeof(sample); });
}

/// "uint8", "int8", ..., "float64".
constexpr std::string_view sample_name(SampleType type) {
  constexpr std::string_view names[] = {"uint8", "int8",   "uint16", "int16",   "uint32",
                                        "int32", "uint64", "int64",  "float32", "float64"};
  return names[static_cast<std::size_t>(type)];
}

/// What a file format calls a type. In a table of a format, the first name of a type is the one that we write.
struct TypeName {
  std::string_view name;
  SampleType type;
};

/// The type of that name in the table, if any.
inline std::optional<SampleType> type_named(std::string_view name, std::span<const TypeName> table) {
  for (const TypeName& known : table)
    if (known.name == name) return known.type;
  return std::nullopt;
}

/// The name of a type in the table; empty when it has none.
inline std::string_view name_of(SampleType type, std::span<const TypeName> table) {
  for (const TypeName& known : table)
    if (known.type == type) return known.name;
  return {};
}

}  // namespace csrbf
