#pragma once

#include "csrbf/io/files/bytes.hpp"
#include "csrbf/io/files/text.hpp"

namespace csrbf {

/// The type called `name` in either convention (int or int32), if any.
std::optional<SampleType> ply_type(std::string_view name);

struct PlyProperty {
  std::string name;
  SampleType type = SampleType::float32;  ///< of the value, or of the list's items
  std::optional<SampleType> count_type;   ///< set for lists only
};

struct PlyElement {
  std::string name;
  Index count = 0;
  std::vector<PlyProperty> properties;

  [[nodiscard]] bool has_lists() const;
  /// Smallest size of one such element in a binary file, in bytes.
  [[nodiscard]] std::size_t smallest_binary_size() const;
};

enum class PlyEncoding { ascii, little_endian, big_endian };

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::ascii;
  std::vector<PlyElement> elements;
};

/// Reads a header (elements without properties are dropped) up to and including its last line; `reader` is left after
/// it. Throws IoError with the line.
PlyHeader parse_ply_header(LineReader& reader);

}  // namespace csrbf
