#pragma once

#include "csrbf/io/images/sample_codec.hpp"

namespace csrbf {

/// Reads a NRRD file (versions 1 to 5; raw, gzip or ascii; samples after the header or in one other file). A first axis
/// of kind vector, colour and the like holds components; a last one of kind time, or a fourth in space, is time. Throws
/// IoError "path:line: ...".
RawVolume parse_nrrd(std::string bytes, const std::string& path);

/// A NRRD file with compressed samples.
FileParts format_nrrd(const VolumeLayout& layout, const std::string& samples);

}  // namespace csrbf
