#pragma once

#include "csrbf/core/grid.hpp"

#include <string>

namespace csrbf {

/// Reads an image of numbers; its extension says the format:
/// - .png, .pgm, .ppm: pictures of 8 and 16 bits; .tif, .tiff: pages are slices.
/// - .nii, .nii.gz, .nrrd, .mha, .mhd: with spacing, origin and direction. Lengths are mm where the file says its unit.
/// - .vti: images of VTK and ParaView, with spacing, origin and direction as they are in the file.
/// - .npy: [x], [y, x], [z, y, x] or [t, z, y, x]; see io/images/npy_volume.hpp for axes of components.
/// - .dcm, other DICOM files and folders of them, when built with GDCM: see io/images/dicom.hpp.
/// Without a header voxels have size 1 and the first is centred at the origin. Samples with a scale (NIfTI) become
/// floats; NaN is a value like others. Throws IoError naming the file and the place; takes memory only when the file
/// can hold what its header promises.
template <class Scalar = float>
Volume<Scalar> read_volume(const std::string& path);

/// Writes an image in the format of the extension and in samples of volume.type, complete or not at all (AtomicFile;
/// .mhd: the samples first, as .raw). Integers are rounded and clamped, NaN becomes 0. Positions are converted between
/// the spaces of the formats; .png .pgm .ppm .tif and .npy hold none. .png .pgm .ppm take 8 or 16 bits, whichever holds
/// the values of other integer types. Throws IoError for what the format cannot hold; InvalidInput when values and
/// sizes do not match.
template <class Scalar>
void write_volume(const std::string& path, const Volume<Scalar>& volume);

/// True when the extension is one of an image that write_volume() writes.
bool is_volume_file(const std::string& path);

/// True when it is one of an image, or when the path is a DICOM file or a folder.
bool is_readable_volume(const std::string& path);

/// True when it is one of a picture, which holds whole numbers only: .png .pgm .ppm.
bool is_picture_file(const std::string& path);

}  // namespace csrbf
