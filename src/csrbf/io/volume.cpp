#include "csrbf/io/volume.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/atomic_file.hpp"
#include "csrbf/io/files/deflate.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/images/dicom.hpp"
#include "csrbf/io/images/formats.hpp"
#include "csrbf/io/vtk/formats.hpp"

#include <filesystem>

namespace csrbf {
namespace {

constexpr const char* extensions = ".png .pgm .ppm .tif .tiff .nii .nii.gz .nrrd .mha .mhd .npy .vti";

std::string volume_extension(const std::string& path) {
  const std::string last = file_extension(path);
  return last == ".gz" ? file_extension(std::filesystem::path(path).stem().string()) + last : last;
}

// `others` are kinds of images without an extension here.
std::string checked_extension(const std::string& path, const std::string& others = {}) {
  const std::string extension = volume_extension(path);
  if (!is_listed(extension, extensions)) refuse_extension(path, extension, "images are " + (extensions + others));
  return extension;
}

RawVolume parse_volume(const std::string& extension, std::string bytes, const std::string& path) {
  if (bytes.empty()) throw IoError(path + ": the file is empty");
  if (extension == ".png") return parse_png(bytes, path);
  if (extension == ".pgm" || extension == ".ppm") return parse_pnm(std::move(bytes), path);
  if (extension.starts_with(".tif")) return parse_tiff(std::move(bytes), path);
  if (extension.starts_with(".nii")) return parse_nifti(std::move(bytes), path);
  if (extension == ".nrrd") return parse_nrrd(std::move(bytes), path);
  if (extension == ".npy") return parse_npy_volume(std::move(bytes), path);
  if (extension == ".vti") return parse_vti(std::move(bytes), path);
  return parse_metaimage(std::move(bytes), path);
}

bool is_picture(const std::string& extension) {
  return is_listed(extension, ".png .pgm .ppm");
}

// Refuses axes and components that the format cannot hold.
void check_shape(const std::string& extension, const VolumeLayout& layout, const std::string& path) {
  const auto check = [&](bool holds, const std::string& what) {
    if (!holds) throw IoError(path + ": " + extension + " files hold no " + what + "; write .nii.gz, .nrrd or .npy");
  };
  if (is_picture(extension)) {
    const Index most = extension == ".png" ? 4 : extension == ".ppm" ? 3 : 1;
    check(layout.grid.size[2] == 1, "third axis");
    check(layout.frames == 1, "time axis");
    check(layout.components <= most && (extension != ".ppm" || layout.components == most),
          "pixels of " + std::to_string(layout.components) + " components");
  }
  if (extension.starts_with(".tif")) {
    constexpr Index most_components = 65535;  // a 16-bit field of TIFF
    check(layout.grid.size[2] == 1 || layout.frames == 1, "sequences of three axes");
    check(layout.components <= most_components, "pixels of " + std::to_string(layout.components) + " components");
  }
  if (extension == ".vti") check(layout.frames == 1, "time axis");
}

// The type in which a picture holds the values: 8 or 16 bits.
template <class Scalar>
SampleType picture_type(const std::string& extension, const Volume<Scalar>& volume, const std::string& path) {
  if (volume.type == SampleType::uint8 || volume.type == SampleType::uint16) return volume.type;
  if (is_floating(volume.type))
    throw IoError(path + ": " + extension + " files hold whole numbers, the image holds " +
                  std::string(sample_name(volume.type)) + "; write .tif, .nii.gz, .nrrd or .npy");
  const auto [lo, hi] = std::minmax_element(volume.values.begin(), volume.values.end());
  constexpr int largest_8 = 255;
  constexpr int largest_16 = 65535;
  if (lo == volume.values.end() || !(*lo >= 0 && *hi <= largest_16))
    throw IoError(path + ": " + extension + " files hold whole numbers from 0 to 65535, the image reaches from " +
                  std::to_string(*lo) + " to " + std::to_string(*hi) + "; write .tif, .nii.gz, .nrrd or .npy");
  return *hi <= largest_8 ? SampleType::uint8 : SampleType::uint16;
}

FileParts format_volume(const std::string& extension, const VolumeLayout& layout, std::string samples,
                        const std::string& path) {
  if (extension == ".png") return format_png(layout, samples, path);
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
  const std::string extension = checked_extension(path, ", and DICOM files or folders");
  return decode_samples<Scalar>(parse_volume(extension, read_file(path), path));
}

template <class Scalar>
void write_volume(const std::string& path, const Volume<Scalar>& volume) {
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
  if (extension != ".mhd") {
    return write_parts(path, format_volume(extension, layout, std::move(samples), path));
  }
  const std::filesystem::path data = std::filesystem::path(path).replace_extension(".raw");
  const FileParts parts = format_metaimage(layout, std::move(samples), data.filename().string());
  write_file(data.string(), parts.body);
  write_file(path, parts.head);
}

template Volume<float> read_volume(const std::string&);
template Volume<double> read_volume(const std::string&);
template void write_volume(const std::string&, const Volume<float>&);
template void write_volume(const std::string&, const Volume<double>&);

bool is_volume_file(const std::string& path) {
  return is_listed(volume_extension(path), extensions);
}

bool is_readable_volume(const std::string& path) {
  return is_volume_file(path) || is_dicom(path);
}

bool is_picture_file(const std::string& path) {
  return is_picture(volume_extension(path));
}

}  // namespace csrbf
