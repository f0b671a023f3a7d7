#pragma once

#include "csrbf/io/images/sample_codec.hpp"

namespace csrbf {

/// Reads a .pgm or .ppm file: P2, P3, P5, P6; 8 bits per sample, 16 when the largest value is above 255. Throws
/// IoError.
RawVolume parse_pnm(std::string bytes, const std::string& name);

/// A binary .pgm (1 component) or .ppm (3) file from little-endian uint8 or uint16 samples of one 2D frame.
FileParts format_pnm(const VolumeLayout& layout, std::string samples);

}  // namespace csrbf
