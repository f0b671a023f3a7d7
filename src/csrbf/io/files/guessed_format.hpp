#pragma once

#include <string>
#include <string_view>

namespace csrbf {

/// The extension of the format whose files begin like these bytes: ".ply", ".tif", ...; empty for text without a mark,
/// and for what is not known.
std::string guessed_format(std::string_view bytes);

}  // namespace csrbf
