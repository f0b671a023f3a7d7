#pragma once

#include "csrbf/io/images/sample_codec.hpp"

namespace csrbf {

/// Reads a TIFF file: all pages of the first page's size and type become slices along z. Grey, RGB and more samples per
/// pixel of 8 to 64 bits, integers or floats, in strips or tiles of any compression that libtiff knows. Pixels have
/// size 1: the resolutions that cameras and scanners write are not physical lengths. Throws IoError.
RawVolume parse_tiff(std::string bytes, const std::string& name);

/// An uncompressed TIFF file (BigTIFF from 4 GB on) with one page per slice, or per frame of 2D pictures. Throws
/// IoError.
FileParts format_tiff(const VolumeLayout& layout, std::string_view samples, const std::string& name);

}  // namespace csrbf
