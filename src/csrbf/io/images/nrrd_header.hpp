#pragma once

#include "csrbf/io/images/raw_data.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace csrbf {

/// One axis of a NRRD file; the first is the fastest.
struct NrrdAxis {
  Index size = 0;
  std::string kind;                   ///< "domain", "vector", "time", ...; empty: not given
  std::optional<Point<3>> direction;  ///< step in space; none: the axis does not lie in space
  double spacing = 0;                 ///< 0: not given

  /// True when, by its kind, the axis holds the components of one value.
  [[nodiscard]] bool is_components() const;
};

struct NrrdHeader {
  SampleType type = SampleType::uint8;
  std::endian order = std::endian::little;
  std::vector<NrrdAxis> axes;
  Space space = Space::unknown;
  int space_dimension = 0;
  double flip_x = 1;  ///< converts x of the file to that of `space`
  Point<3> origin = Point<3>::Zero();
  RawData data;
};

/// Reads the header up to the blank line that ends it. Throws IoError "name:line: ...".
NrrdHeader parse_nrrd_header(std::string_view bytes, const std::string& name);

/// The name of a sample type in a NRRD header.
std::string_view nrrd_type_name(SampleType type);

}  // namespace csrbf
