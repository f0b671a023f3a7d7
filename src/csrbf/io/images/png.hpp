#pragma once

#include "csrbf/io/images/sample_codec.hpp"

namespace csrbf {

/// Reads a .png picture of 1 (grey), 2 (grey, alpha), 3 (RGB) or 4 (RGBA) components. 1 to 8 bits become uint8 with the
/// values as stored, 16 bits uint16; palettes are expanded to RGB. Throws IoError.
RawVolume parse_png(const std::string& bytes, const std::string& name);

/// A .png file from little-endian uint8 or uint16 samples of one 2D frame of 1 to 4 components. Throws IoError.
FileParts format_png(const VolumeLayout& layout, std::string_view samples, const std::string& name);

}  // namespace csrbf
