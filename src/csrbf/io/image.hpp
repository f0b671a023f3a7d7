#pragma once

#include "csrbf/core/image.hpp"

#include <string>

namespace csrbf {

/// Writes an 8-bit RGB picture as .png, completely or not at all. Throws IoError, also for other extensions;
/// InvalidInput if the picture is empty or its pixels do not match its size.
void write_png(const std::string& path, const RgbImage& image);

}  // namespace csrbf
