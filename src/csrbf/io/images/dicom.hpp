#pragma once

#include "csrbf/io/images/sample_codec.hpp"

namespace csrbf {

/// Was the library built with GDCM, so that it can read DICOM files?
bool reads_dicom();

/// Is it a folder, or a DICOM file by its extension .dcm or by its first bytes? Others cannot be read as DICOM.
bool is_dicom(const std::string& path);

/// Reads a DICOM file, or the images in a folder (not in its subfolders; other files are ignored) as slices of one
/// image, ordered along their normal. Slices must belong to one series and agree in size, type and orientation; their
/// positions must lie evenly spaced on a line (to 1 % of the spacing), not necessarily along the normal (tilted
/// gantry). Sequences in one file (ultrasound, angiography) become frames, those of other multi-frame files become
/// slices. Positions are in LPS, lengths in mm. Rescale slope and intercept are applied by decode_samples(); samples
/// become float32 here when these differ between slices.
///
/// Throws IoError that names the file: for mixed series (it lists them), missing or repeated slices, colour
/// images, samples that are not whole bytes, files that are damaged or not DICOM; and for any file when built without
/// GDCM.
RawVolume read_dicom(const std::string& path);

}  // namespace csrbf
