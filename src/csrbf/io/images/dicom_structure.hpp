#pragma once

#include <string_view>

namespace csrbf::dicom {

/// Do the bytes begin as those of a DICOM file, with the preamble?
bool has_preamble(std::string_view bytes);

/// Are all elements of a DICOM file there, with lengths that fit into each other? Little-endian transfer syntaxes only;
/// of the others no more than the header is looked at. Readers may rely on it: GDCM may stop the program otherwise.
bool is_whole(std::string_view bytes);

}  // namespace csrbf::dicom
