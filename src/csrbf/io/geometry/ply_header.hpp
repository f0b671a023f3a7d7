#pragma once

#include "csrbf/io/files/text.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace csrbf {

/// The scalar types of PLY files, under their traditional names.
enum class PlyType { char_, uchar, short_, ushort, int_, uint, float_, double_ };

/// The type called `name` in either convention (int or int32), if any.
std::optional<PlyType> ply_type(std::string_view name);

/// The traditional name: char uchar short ushort int uint float double.
std::string_view ply_type_name(PlyType type);

/// Bytes of one value in a binary file.
std::size_t ply_type_size(PlyType type);

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::float_;     ///< of the value, or of the list's items
  std::optional<PlyType> count_type;  ///< set for lists only
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
