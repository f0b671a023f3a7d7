#pragma once

#include "csrbf/io/images/sample_codec.hpp"

namespace csrbf {

/// Reads a NIfTI-1 or NIfTI-2 file, plain or compressed with gzip, in either byte order. The position in space is the
/// sform, else the qform, else the voxel sizes; lengths are converted to mm and times to s. Samples with a scale become
/// floats. Axis 4 is time, axis 5 and RGB types are components. Throws IoError.
RawVolume parse_nifti(std::string bytes, const std::string& name);

/// A NIfTI-1 file (NIfTI-2 when an axis has more than 32767 voxels) from little-endian samples; positions in the space
/// that NIfTI prescribes (RAS): x to the right, y to the front, z up.
FileParts format_nifti(const VolumeLayout& layout, std::string samples);

}  // namespace csrbf
