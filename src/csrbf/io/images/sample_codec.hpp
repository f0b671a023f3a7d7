#pragma once

#include "csrbf/io/files/bytes.hpp"

namespace csrbf {

/// Samples of an image file: in the order of Volume, or one component after the other ("planar").
struct RawVolume {
  VolumeLayout layout;
  std::string bytes;       ///< samples from `offset` on: the file itself when they are not compressed
  std::size_t offset = 0;  ///< avoids a second copy when reading
  std::endian order = std::endian::native;
  bool planar = false;  ///< the component index varies slowest
  double slope = 1;     ///< value = slope * sample + intercept
  double intercept = 0;
  std::optional<double> no_data = {};  ///< the sample that means that there is none; becomes NaN unless it is unsigned

  [[nodiscard]] std::size_t samples() const {
    return static_cast<std::size_t>(layout.values_per_frame() * layout.frames);
  }
  [[nodiscard]] std::size_t byte_count() const { return samples() * sample_size(layout.type); }
};

/// A file to be written: both parts, one after the other.
struct FileParts {
  std::string head;
  std::string body;
};

/// Writes both, complete or not at all (AtomicFile).
void write_parts(const std::string& path, const FileParts& parts);

/// Values of the samples; raw.bytes must hold byte_count() bytes after its offset. Their memory is given back while
/// they are decoded. Parallel.
template <class Scalar>
Volume<Scalar> decode_samples(RawVolume raw);

/// The type of the values: scaled samples, and those among which are NaN, are no longer integers.
SampleType value_type(const RawVolume& raw);

/// Some of the values into an array, from the first one on; raw.bytes holds their samples.
template <class Scalar>
void decode_samples(const RawVolume& raw, std::span<Scalar> to);

/// Values as little-endian samples: integers are rounded and clamped, NaN becomes 0. Parallel.
template <class Scalar>
std::string encode_samples(const Volume<Scalar>& volume, SampleType type);

/// Bytes of all samples of a layout that was read from a file. Throws IoError when an axis is not positive, when there
/// are more than 2^40 samples, or when they need more than `available` bytes: before any memory is allocated.
std::size_t checked_sample_bytes(const VolumeLayout& layout, std::uint64_t available, const std::string& name);

/// As above for samples compressed into `compressed` bytes: deflate shrinks by less than a factor of 1100.
std::size_t checked_deflated_bytes(const VolumeLayout& layout, std::uint64_t compressed, const std::string& name);

/// Makes the columns of `linear` (direction * diag(spacing)) the grid's axes; the last may be 0 for a single slice.
/// Throws IoError for a singular matrix and for numbers that are not finite.
void set_axes(Grid& grid, const Eigen::Matrix3d& linear, const std::string& name);

}  // namespace csrbf
