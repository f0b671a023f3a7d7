#pragma once

#include "csrbf/core/grid.hpp"

#include <string>
#include <vector>

namespace csrbf {

/// Reads an image; its extension determines the format:
/// - .png, .pgm, .ppm, .bmp and, if built with libjpeg, .jpg: pictures with 8 or 16 bits.
/// - .tif, .tiff: pages are slices; GeoTIFF tags or a world file (.tfw) give the position on a map.
/// - .asc, .nc, .hgt, .grd: with the position on a map; if built with GDAL.
/// - .nii, .nii.gz, .nrrd, .mha, .mhd: with spacing, origin and direction, in mm if the file gives the unit.
/// - .vti: images of VTK and ParaView, with spacing, origin and direction as they are in the file.
/// - .npy: [x], [y, x], [z, y, x] or [t, z, y, x]. A last axis of length 3 or 4 after [y, x] of more than 4 each, or of
///   length 2 to 4 in an array of four axes or after [t, z, y, x], holds components.
/// - .dcm, other DICOM files and folders of them, if built with GDCM: the images in a folder become slices, ordered
///   along their normal. They must belong to one series, agree in size, type and orientation, and be evenly spaced.
///   Positions are in LPS, lengths in mm.
///
/// Without a header, voxels have size 1 and the first one is centred at the origin. Samples with a scale (NIfTI) become
/// floats; NaN is a valid value. Memory is allocated only if the file can hold what its header promises. Throws IoError
/// with the file and the position in it.
template <class Scalar = float>
Volume<Scalar> read_volume(const std::string& path);

/// Writes an image in the format of the extension, with samples of volume.type, completely or not at all (.mhd: first
/// the samples, as .raw). Integers are rounded and clamped, NaN becomes 0. Positions are converted to the space of the
/// format; pictures and .npy hold none; .tif holds them as GeoTIFF, with a world file (.tfw) beside it. Pictures get 8
/// or 16 bits, whichever hold the values of other integer types. `names` are those of the components; .nc stores that
/// of a single one. Throws IoError for what the format cannot hold; InvalidInput if values and sizes do not match.
template <class Scalar>
void write_volume(const std::string& path, const Volume<Scalar>& volume, const std::vector<std::string>& names = {});

/// Whether write_volume() writes images with this extension.
bool is_volume_file(const std::string& path);

/// Whether the path is that of an image, a DICOM file or a folder.
bool is_readable_volume(const std::string& path);

/// Whether write_volume() writes images with this extension that can hold labels: not .ppm, which has colours only, and
/// not .jpg, which loses accuracy.
bool is_label_file(const std::string& path);

/// Whether the extension is that of an image on a map, .tif .asc .nc, whose first row is the northernmost.
bool is_map_file(const std::string& path);

/// Whether the extension is that of a picture, which holds whole numbers only: .png .pgm .ppm .jpg .bmp.
bool is_picture_file(const std::string& path);

}  // namespace csrbf
