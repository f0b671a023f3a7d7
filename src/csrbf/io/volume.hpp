#pragma once

#include "csrbf/core/grid.hpp"

#include <string>
#include <vector>

namespace csrbf {

/// Reads an image of numbers; its extension determines the format:
/// - .png, .pgm, .ppm, .bmp and, when libjpeg was found at build, .jpg: pictures of 8 and 16 bits.
/// - .tif, .tiff: pages are slices; the tags of GeoTIFF or a world file (.tfw) give the place on a map.
/// - .asc, .nc, .hgt, .grd, with their place on a map, by GDAL when it was found at build.
/// - .nii, .nii.gz, .nrrd, .mha, .mhd: with spacing, origin and direction. Lengths are in mm where the file gives their
/// unit.
/// - .vti: images of VTK and ParaView, with spacing, origin and direction as they are in the file.
/// - .npy: [x], [y, x], [z, y, x] or [t, z, y, x]; see io/images/formats.hpp for axes of components.
/// - .dcm, other DICOM files and folders of them, when built with GDCM: see io/images/dicom.hpp.
/// Without a header, voxels have size 1 and the first is centred at the origin. Samples with a scale (NIfTI) become
/// floats; NaN is a valid value. Throws IoError with the file and the position in it; allocates memory only when the
/// file can hold what its header promises.
template <class Scalar = float>
Volume<Scalar> read_volume(const std::string& path);

/// Writes an image in the format of the extension and in samples of volume.type, complete or not at all (AtomicFile;
/// .mhd: the samples first, as .raw). Integers are rounded and clamped, NaN becomes 0. Positions are converted between
/// the spaces of the formats; pictures and .npy hold none; .tif has them as GeoTIFF, with a world file (.tfw) beside
/// it. Pictures take 8 or 16 bits, whichever holds the values of other integer types. `names` are those of the
/// components; .nc has that of a single one. Throws IoError for what the format cannot hold; InvalidInput when values
/// and sizes do not match.
template <class Scalar>
void write_volume(const std::string& path, const Volume<Scalar>& volume, const std::vector<std::string>& names = {});

/// True for the extension of an image that write_volume() writes.
bool is_volume_file(const std::string& path);

/// True for the extension of an image, a DICOM file or a folder.
bool is_readable_volume(const std::string& path);

/// True for the extension of an image that write_volume() writes and that can hold labels: neither colour alone (.ppm)
/// nor with losses (.jpg).
bool is_label_file(const std::string& path);

/// True for the extension of an image on a map: .tif .asc .nc, whose first row is the northernmost.
bool is_map_file(const std::string& path);

/// True for the extension of a picture, which holds whole numbers only: .png .pgm .ppm .jpg .bmp.
bool is_picture_file(const std::string& path);

}  // namespace csrbf
