#pragma once

#include "csrbf/io/images/sample_codec.hpp"

namespace csrbf {

/// Reads an array [x], [y, x], [z, y, x] or [t, z, y, x]. A last axis of length 3 or 4 after [y, x] of more than 4
/// each, and one of 2 to 4 in an array of four axes or after [t, z, y, x], holds components. Throws IoError.
RawVolume parse_npy_volume(std::string bytes, const std::string& name);

/// The .npy file of little-endian samples; a single frame has no time axis, a single component no axis of components.
FileParts format_npy_volume(const VolumeLayout& layout, std::string samples);

}  // namespace csrbf
