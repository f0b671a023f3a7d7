#pragma once

#include <string_view>

namespace csrbf::dicom {

/// Do the bytes begin like a DICOM file, with the preamble?
bool has_preamble(std::string_view bytes);

/// Are all elements of a DICOM file present, with consistent lengths? Little-endian transfer syntaxes only; of the
/// others only the header is checked. To be called before GDCM, which may abort the program on damaged files.
bool is_whole(std::string_view bytes);

}  // namespace csrbf::dicom
