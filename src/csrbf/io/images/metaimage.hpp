#pragma once

#include "csrbf/io/images/sample_codec.hpp"

namespace csrbf {

/// Reads a MetaImage: .mha, or .mhd with its samples in another file; raw, compressed or ascii. Positions are in the
/// space of ITK (LPS): x to the left, y to the back, z up. Throws IoError "path:line: ...".
RawVolume parse_metaimage(std::string bytes, const std::string& path);

/// The header and the samples of a MetaImage; `data_file` is LOCAL for .mha, else the name of the file of the samples.
FileParts format_metaimage(const VolumeLayout& layout, std::string samples, const std::string& data_file);

}  // namespace csrbf
