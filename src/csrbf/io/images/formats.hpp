#pragma once

#include "csrbf/io/images/sample_codec.hpp"

namespace csrbf {

/// Reads a MetaImage: .mha, or .mhd with its samples in another file; raw, compressed or ascii. Positions are in the
/// space of ITK (LPS): x to the left, y to the back, z up. Throws IoError "path:line: ...".
RawVolume parse_metaimage(std::string bytes, const std::string& path);

/// The header and the samples of a MetaImage; `data_file` is LOCAL for .mha, else the name of the file of the samples.
FileParts format_metaimage(const VolumeLayout& layout, std::string samples, const std::string& data_file);

/// Reads a NIfTI-1 or NIfTI-2 file, plain or compressed with gzip, in either byte order. The position in space is the
/// sform, else the qform, else the voxel sizes; lengths are converted to mm and times to s. Samples with a scale become
/// floats. Axis 4 is time, axis 5 and RGB types are components. Throws IoError.
RawVolume parse_nifti(std::string bytes, const std::string& name);

/// What the header of a NIfTI file that is not compressed says, and where the samples begin; `head`: the first 540
/// bytes at least, or the whole file. Their number is not checked. Throws IoError.
RawVolume parse_nifti_head(std::string_view head, const std::string& name);

/// A NIfTI-1 file (NIfTI-2 when an axis has more than 32767 voxels) from little-endian samples; positions in the space
/// that NIfTI prescribes (RAS): x to the right, y to the front, z up.
FileParts format_nifti(const VolumeLayout& layout, std::string samples);

/// Reads an array [x], [y, x], [z, y, x] or [t, z, y, x]. A last axis of length 3 or 4 after [y, x] of more than 4
/// each, and one of 2 to 4 in an array of four axes or after [t, z, y, x], holds components. Throws IoError.
RawVolume parse_npy_volume(std::string bytes, const std::string& name);

/// What the header of a .npy file says, and where the samples begin; `head`: all of the header at least. Nothing when
/// the samples are not in the order of Volume. Throws IoError.
std::optional<RawVolume> parse_npy_volume_head(std::string_view head, const std::string& name);

/// The .npy file of little-endian samples; a single frame has no time axis, a single component no axis of components.
FileParts format_npy_volume(const VolumeLayout& layout, std::string samples);

/// Reads a NRRD file (versions 1 to 5; raw, gzip or ascii; samples after the header or in one other file). A first axis
/// of kind vector, colour and the like holds components; a last one of kind time, or a fourth in space, is time. Throws
/// IoError "path:line: ...".
RawVolume parse_nrrd(std::string bytes, const std::string& path);

/// A NRRD file with compressed samples.
FileParts format_nrrd(const VolumeLayout& layout, const std::string& samples);

/// Reads a .png picture of 1 (grey), 2 (grey, alpha), 3 (RGB) or 4 (RGBA) components. 1 to 8 bits become uint8 with the
/// values as stored, 16 bits uint16; palettes are expanded to RGB. Throws IoError.
RawVolume parse_png(const std::string& bytes, const std::string& name);

/// A .png file from little-endian uint8 or uint16 samples of one 2D frame of 1 to 4 components. Throws IoError.
FileParts format_png(const VolumeLayout& layout, std::string_view samples, const std::string& name);

/// Reads a .pgm or .ppm file: P2, P3, P5, P6; 8 bits per sample, 16 when the largest value is above 255. Throws
/// IoError.
RawVolume parse_pnm(std::string bytes, const std::string& name);

/// A binary .pgm (1 component) or .ppm (3) file from little-endian uint8 or uint16 samples of one 2D frame.
FileParts format_pnm(const VolumeLayout& layout, std::string samples);

/// Reads a .jpg picture of 1 (grey) or 3 (RGB) components, by libjpeg; in builds without it IoError with what to do.
RawVolume parse_jpeg(std::string_view bytes, const std::string& name);
/// Is libjpeg there?
bool reads_jpeg();

/// A .jpg file of little quality loss from uint8 samples of 1 or 3 components. Throws IoError.
FileParts format_jpeg(const VolumeLayout& layout, std::string_view samples, const std::string& name);

/// Reads a .bmp picture: uncompressed, 1 to 8 bits with a palette (grey palettes become one component), 24 or 32 bits.
/// Throws IoError.
RawVolume parse_bmp(std::string_view bytes, const std::string& name);

/// An uncompressed .bmp file from uint8 samples of 1 or 3 components.
FileParts format_bmp(const VolumeLayout& layout, std::string_view samples);

/// An image on a map, by GDAL. Throws IoError, also where there is no GDAL.
RawVolume read_gdal_image(const std::string& path);

/// Writes an image of two axes by GDAL, complete or not at all. `samples`: little-endian.
void write_gdal_image(const std::string& path, const VolumeLayout& layout, const std::string& samples,
                      const std::vector<std::string>& names);

/// Reads a TIFF file: all pages of the first page's size and type become slices along z. Grey, RGB and more samples per
/// pixel of 8 to 64 bits, integers or floats, in strips or tiles of any compression that libtiff knows. The tags of
/// GeoTIFF give the place; without them pixels have size 1: the resolutions that cameras and scanners write are not
/// physical lengths. Throws IoError.
RawVolume parse_tiff(std::string bytes, const std::string& name);

/// An uncompressed TIFF file (BigTIFF from 4 GB on) with one page per slice, or per frame of 2D pictures, and with the
/// tags of GeoTIFF where the grid or its reference system says more than the numbers of the pixels. Throws IoError.
FileParts format_tiff(const VolumeLayout& layout, std::string_view samples, const std::string& name);

}  // namespace csrbf
