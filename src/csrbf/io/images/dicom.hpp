#pragma once

#include "csrbf/io/images/sample_codec.hpp"

#include <string>

namespace csrbf {

/// Was the library built with GDCM, and can read DICOM files?
bool reads_dicom();

/// Is it a folder, or a DICOM file by its extension .dcm or by its first bytes? Others cannot be read as DICOM.
bool is_dicom(const std::string& path);

/// Reads a DICOM file, or the images in a folder (not in those within it; other files are left aside) as slices of one
/// image, ordered along their normal. Slices must belong to one series and agree in size, type and orientation; their
/// positions must lie on a line at even distances (to 1 % of them), which need not be along the normal (tilted gantry).
/// Sequences in one file (ultrasound, angiography) become frames, other files of several frames slices. Positions are
/// in LPS, lengths in mm. Rescale slope and intercept are applied by decode_samples(); samples become float32 here
/// where they differ between slices.
///
/// Throws IoError that names the file: for mixed series (it lists them), missing or repeated slices, pictures in
/// colour, samples that are not whole bytes, files that are damaged or no DICOM files; and for all when built without
/// GDCM.
RawVolume read_dicom(const std::string& path);

}  // namespace csrbf
