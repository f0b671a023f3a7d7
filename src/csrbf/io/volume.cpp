#include "csrbf/io/volume.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/atomic_file.hpp"
#include "csrbf/io/files/deflate.hpp"
#include "csrbf/io/files/guessed_format.hpp"
#include "csrbf/io/files/gzip_file.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/gdal/gdal.hpp"
#include "csrbf/io/images/dicom.hpp"
#include "csrbf/io/images/formats.hpp"
#include "csrbf/io/images/geotiff.hpp"
#include "csrbf/io/vtk/formats.hpp"

#include <filesystem>

namespace csrbf {
namespace {

constexpr const char* volume_extensions =
    ".png .pgm .ppm .jpg .jpeg .bmp .tif .tiff .nii .nii.gz .nrrd .mha .mhd .npy .vti .asc .nc";
constexpr const char* read_by_gdal = ".hgt .grd";  // besides .asc and .nc, which it writes too

std::string volume_extension(const std::string& path) {
  const std::string last = file_extension(path);
  return last == ".gz" ? file_extension(std::filesystem::path(path).stem().string()) + last : last;
}

std::string checked_extension(const std::string& path) {
  std::string extension = volume_extension(path);
  if (!is_listed(extension, volume_extensions))
    refuse_extension(path, extension, std::string("images are ") + volume_extensions);
  return extension;
}

// Pictures of maps may have a file beside them that says where they are: dem.tfw for dem.tif.
bool has_world_file(const std::string& extension) {
  return is_listed(extension, ".tif .tiff .png .jpg .jpeg .bmp");
}

std::string world_file_of(const std::string& path) {
  const std::string extension = file_extension(path);
  const std::string world{'.', extension[1], extension.back(), 'w'};
  return std::filesystem::path(path).replace_extension(world).string();
}

void read_world_file(const std::string& path, Grid& grid) {
  if (path == "-" || file_extension(path) != volume_extension(path)) return;
  const std::string world = world_file_of(path);
  std::error_code error;
  if (std::filesystem::is_regular_file(world, error)) parse_world_file(read_file(world), grid, world);
}

// Enough of compressed bytes to see what they are.
std::string read_head(const std::string& bytes, const std::string& name) {
  constexpr std::size_t head = 512;
  return inflate_head(bytes, head, display_name(name));
}

bool is_by_gdal(const std::string& extension) {
  return extension == ".asc" || extension == ".nc" || is_listed(extension, read_by_gdal);
}

// What a file compressed as a whole holds, ".npy" of "a.npy.gz"; empty for .nii.gz, a format of its own, and others.
std::string packed_extension(const std::string& path) {
  const std::string held = content_extension(path);
  const bool is_packed = file_extension(path) == ".gz" && held != ".nii" && !is_by_gdal(held);
  return is_packed && is_listed(held, volume_extensions) ? held : "";
}

RawVolume parse_volume(const std::string& extension, std::string bytes, const std::string& path) {
  if (is_by_gdal(extension)) return read_gdal_image(path);
  if (bytes.empty()) throw IoError(path + ": the file is empty");
  if (extension == ".png") return parse_png(bytes, path);
  if (extension == ".pgm" || extension == ".ppm") return parse_pnm(std::move(bytes), path);
  if (extension.starts_with(".jp")) return parse_jpeg(bytes, path);
  if (extension == ".bmp") return parse_bmp(bytes, path);
  if (extension.starts_with(".tif")) return parse_tiff(std::move(bytes), path);
  if (extension.starts_with(".nii")) return parse_nifti(std::move(bytes), path);
  if (extension == ".nrrd") return parse_nrrd(std::move(bytes), path);
  if (extension == ".npy") return parse_npy_volume(std::move(bytes), path);
  if (extension == ".vti") return parse_vti(std::move(bytes), path);
  return parse_metaimage(std::move(bytes), path);
}

bool is_picture(const std::string& extension) {
  return is_listed(extension, ".png .pgm .ppm .jpg .jpeg .bmp");
}

// Refuses axes and components that the format cannot hold.
void check_shape(const std::string& extension, const VolumeLayout& layout, const std::string& path) {
  const auto check = [&](bool holds, const std::string& what) {
    if (!holds) throw IoError(path + ": " + extension + " files hold no " + what + "; write .nii.gz, .nrrd or .npy");
  };
  if (is_picture(extension)) {
    const Index most = extension == ".png" ? 4 : extension == ".pgm" ? 1 : 3;
    check(layout.grid.size[2] == 1, "third axis");
    check(layout.frames == 1, "time axis");
    const bool is_jpeg_or_bmp = extension.starts_with(".jp") || extension == ".bmp";
    check(layout.components <= most && (extension != ".ppm" || layout.components == most) &&
              (!is_jpeg_or_bmp || layout.components != 2),
          "pixels of " + std::to_string(layout.components) + " components");
  }
  if (extension.starts_with(".tif")) {
    constexpr Index most_components = 65535;  // a 16-bit field of TIFF
    check(layout.grid.size[2] == 1 || layout.frames == 1, "sequences of three axes");
    check(layout.components <= most_components, "pixels of " + std::to_string(layout.components) + " components");
  }
  if (extension == ".vti" || is_by_gdal(extension)) check(layout.frames == 1, "time axis");
  if (is_by_gdal(extension)) check(layout.grid.size[2] == 1, "third axis");
}

// The type in which a picture holds the values: 8 or 16 bits.
template <class Scalar>
SampleType picture_type(const std::string& extension, const Volume<Scalar>& volume, const std::string& path) {
  const bool only_bytes = extension.starts_with(".jp") || extension == ".bmp";
  if (volume.type == SampleType::uint8 || (volume.type == SampleType::uint16 && !only_bytes)) return volume.type;
  if (is_floating(volume.type))
    throw IoError(path + ": " + extension + " files hold whole numbers, the image holds " +
                  std::string(sample_name(volume.type)) + "; write .tif, .nii.gz, .nrrd or .npy");
  const auto [lo, hi] = std::minmax_element(volume.values.begin(), volume.values.end());
  constexpr int largest_8 = 255;
  const int largest = only_bytes ? largest_8 : 65535;
  if (lo == volume.values.end() || !(*lo >= 0 && *hi <= static_cast<Scalar>(largest)))
    throw IoError(path + ": " + extension + " files hold whole numbers from 0 to " + std::to_string(largest) +
                  ", the image reaches from " + std::to_string(*lo) + " to " + std::to_string(*hi) +
                  "; write .tif, .nii.gz, .nrrd or .npy");
  return *hi <= largest_8 ? SampleType::uint8 : SampleType::uint16;
}

FileParts format_volume(const std::string& extension, const VolumeLayout& layout, std::string samples,
                        const std::string& path) {
  if (extension == ".png") return format_png(layout, samples, path);
  if (extension.starts_with(".jp")) return format_jpeg(layout, samples, path);
  if (extension == ".bmp") return format_bmp(layout, samples);
  if (is_picture(extension)) return format_pnm(layout, std::move(samples));
  if (extension.starts_with(".tif")) return format_tiff(layout, samples, path);
  if (extension == ".nrrd") return format_nrrd(layout, samples);
  if (extension == ".npy") return format_npy_volume(layout, std::move(samples));
  if (extension == ".vti") return format_vti(layout, std::move(samples));
  if (extension == ".mha") return format_metaimage(layout, std::move(samples), "LOCAL");
  FileParts parts = format_nifti(layout, std::move(samples));
  if (extension == ".nii.gz") parts = {deflate_bytes({parts.head, parts.body}, DeflateFormat::gzip), {}};
  return parts;
}

}  // namespace

template <class Scalar>
Volume<Scalar> read_volume(const std::string& path) {
  if (!is_volume_file(path) && is_dicom(path)) return decode_samples<Scalar>(read_dicom(path));
  std::string extension = volume_extension(path), bytes;
  if (extension.empty()) {
    bytes = read_file(path);
    extension = guessed_format(bytes.starts_with("\x1F\x8B") ? read_head(bytes, path) : bytes);
    if (extension == ".nii" && bytes.starts_with("\x1F\x8B")) extension = ".nii.gz";
  }
  if (const std::string packed = packed_extension(path); !packed.empty()) {
    extension = packed;
    bytes = read_content(path);
  }
  if (!is_listed(extension, volume_extensions) && !is_listed(extension, read_by_gdal))
    refuse_extension(display_name(path), extension,
                     std::string("images are ") + volume_extensions + ", and DICOM files or folders");
  if (bytes.empty() && !is_by_gdal(extension)) bytes = read_file(path);
  RawVolume raw = parse_volume(extension, std::move(bytes), display_name(path));
  if (has_world_file(extension) && !is_placed(raw.layout)) read_world_file(path, raw.layout.grid);
  return decode_samples<Scalar>(std::move(raw));
}

template <class Scalar>
void write_volume(const std::string& path, const Volume<Scalar>& volume, const std::vector<std::string>& names) {
  const std::string extension = checked_extension(path);
  const auto& size = volume.grid.size;
  require(*std::min_element(size.begin(), size.end()) >= 1 && volume.frames >= 1 && volume.components >= 1,
          "write_volume", "voxels", volume.grid.voxels(), "every axis must have one voxel at least");
  require(std::ssize(volume.values) == volume.values_per_frame() * volume.frames, "write_volume", "values",
          volume.values.size(), "one per component, voxel and frame is needed");
  check_shape(extension, volume, path);
  VolumeLayout layout = volume;
  if (is_picture(extension)) layout.type = picture_type(extension, volume, path);
  std::string samples = encode_samples(volume, layout.type);
  const bool is_tiff = extension.starts_with(".tif");
  if (is_by_gdal(extension) || (is_tiff && !layout.crs.empty() && !epsg_code(layout.crs)))
    return write_gdal_image(path, layout, samples, names);
  if (extension != ".mhd") {
    write_parts(path, format_volume(extension, layout, std::move(samples), path));
    if (is_tiff && is_placed(layout) && layout.grid.size[2] == 1)
      write_file(world_file_of(path), format_world_file(layout.grid));
    return;
  }
  const std::filesystem::path data = std::filesystem::path(path).replace_extension(".raw");
  const FileParts parts = format_metaimage(layout, std::move(samples), data.filename().string());
  write_file(data.string(), parts.body);
  write_file(path, parts.head);
}

template Volume<float> read_volume(const std::string&);
template Volume<double> read_volume(const std::string&);
template void write_volume(const std::string&, const Volume<float>&, const std::vector<std::string>&);
template void write_volume(const std::string&, const Volume<double>&, const std::vector<std::string>&);

bool is_volume_file(const std::string& path) {
  return is_listed(volume_extension(path), volume_extensions);
}

bool is_readable_volume(const std::string& path) {
  return is_volume_file(path) || !packed_extension(path).empty() || is_listed(volume_extension(path), read_by_gdal) ||
         is_dicom(path);
}

bool is_label_file(const std::string& path) {
  return is_volume_file(path) && !is_listed(volume_extension(path), ".ppm .jpg .jpeg");
}

bool is_map_file(const std::string& path) {
  return is_listed(volume_extension(path), ".tif .tiff .asc .nc");
}

bool is_picture_file(const std::string& path) {
  return is_picture(volume_extension(path));
}

}  // namespace csrbf
