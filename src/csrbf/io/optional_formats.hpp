#pragma once

#include <vector>

namespace csrbf {

/// A format for which a library must be found when this one is built.
struct OptionalPart {
  const char* name;  ///< of the library
  bool is_there;
  const char* what;  ///< the files
};

/// All of them, except those of GDAL, which is looked for at run time (gdal_version()).
std::vector<OptionalPart> optional_formats();

}  // namespace csrbf
