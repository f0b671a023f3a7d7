#pragma once

#include "csrbf/core/image.hpp"

#include <string>

namespace csrbf {

/// Writes an 8-bit RGB picture as PNG, complete or not at all (AtomicFile). Throws IoError, also for other
/// extensions than .png; InvalidInput when the picture is empty or its pixels do not match its size.
void write_png(const std::string& path, const RgbImage& image);

}  // namespace csrbf
