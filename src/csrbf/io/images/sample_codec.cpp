#include "csrbf/io/images/sample_codec.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/io/files/atomic_file.hpp"
#include "csrbf/io/files/discard_bytes.hpp"

#include <Eigen/Geometry>

namespace csrbf {
namespace {

// About 100 us of work per block.
constexpr Index grain = Index{1} << 16;

template <class T>
bool is_missing(T sample, const std::optional<double>& no_data) {
  if constexpr (std::is_floating_point_v<T>) return no_data && sample == narrow_scalar<T>(*no_data);
  return std::is_signed_v<T> && no_data && static_cast<double>(sample) == *no_data;
}

// The values from `first` on.
template <class T, class Scalar>
void decode_as(const RawVolume& raw, Index first, std::span<Scalar> to) {
  const char* bytes = raw.bytes.data() + raw.offset;
  const bool scaled = raw.slope != 1 || raw.intercept != 0;
  const Index components = raw.layout.components;
  const Index voxels = raw.layout.grid.voxels() * raw.layout.frames;
  parallel_for(std::ssize(to), grain, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      const Index at = first + i, source = raw.planar ? (at % components) * voxels + at / components : at;
      const T sample = load_scalar<T>(bytes + source * sizeof(T), raw.order);
      to[i] = scaled ? static_cast<Scalar>(raw.slope * static_cast<double>(sample) + raw.intercept)
                     : static_cast<Scalar>(sample);
      if (is_missing(sample, raw.no_data)) to[i] = std::numeric_limits<Scalar>::quiet_NaN();
    }
  });
}

}  // namespace

SampleType value_type(const RawVolume& raw) {
  const SampleType type = raw.layout.type;
  const bool has_gaps = raw.no_data.has_value() && sample_name(type).starts_with("int");
  const bool keeps = is_floating(type) || (raw.slope == 1 && raw.intercept == 0 && !has_gaps);
  return keeps ? type : sample_size(type) < 4 ? SampleType::float32 : SampleType::float64;
}

template <class Scalar>
Volume<Scalar> decode_samples(RawVolume raw) {
  Volume<Scalar> volume;
  static_cast<VolumeLayout&>(volume) = raw.layout;
  const auto count = static_cast<Index>(raw.samples());
  volume.values.reserve(raw.samples());
  // In parts whose samples are discarded: a large image is in memory once, not twice.
  constexpr Index part = Index{1} << 24;
  for (Index first = 0; first < count; first += part) {
    const Index end = std::min(count, first + part);
    volume.values.resize(static_cast<std::size_t>(end));
    with_sample_type(raw.layout.type, [&](auto sample) {
      decode_as<decltype(sample)>(raw, first, std::span(volume.values).subspan(static_cast<std::size_t>(first)));
    });
    char* samples = raw.bytes.data() + raw.offset;
    const auto size = static_cast<Index>(sample_size(raw.layout.type));
    if (!raw.planar) discard_bytes(samples + first * size, samples + end * size);
  }
  volume.type = value_type(raw);
  return volume;
}

template <class Scalar>
void decode_samples(const RawVolume& raw, std::span<Scalar> to) {
  with_sample_type(raw.layout.type, [&](auto sample) { decode_as<decltype(sample)>(raw, 0, to); });
}

template <class Scalar>
std::string encode_samples(const Volume<Scalar>& volume, SampleType sample_type) {
  std::string bytes(volume.values.size() * sample_size(sample_type), '\0');
  with_sample_type(sample_type, [&](auto type) {
    using T = decltype(type);
    parallel_for(std::ssize(volume.values), grain, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i)
        store_scalar(bytes.data() + i * sizeof(T), narrow_scalar<T>(static_cast<double>(volume.values[i])));
    });
  });
  return bytes;
}

template Volume<float> decode_samples(RawVolume);
template Volume<double> decode_samples(RawVolume);
template void decode_samples(const RawVolume&, std::span<float>);
template void decode_samples(const RawVolume&, std::span<double>);
template std::string encode_samples(const Volume<float>&, SampleType);
template std::string encode_samples(const Volume<double>&, SampleType);

void write_parts(const std::string& path, const FileParts& parts) {
  AtomicFile file(path);
  file.write(parts.head);
  file.write(parts.body);
  file.commit();
}

std::size_t checked_sample_bytes(const VolumeLayout& layout, std::uint64_t available, const std::string& name) {
  constexpr std::uint64_t most = std::uint64_t{1} << 40;  // a limit on damaged files: products do not overflow
  const auto& size = layout.grid.size;
  std::uint64_t samples = 1;
  for (const Index length : {size[0], size[1], size[2], layout.frames, layout.components}) {
    if (length < 1) throw IoError(name + ": the image has an axis of " + std::to_string(length) + " samples");
    if (static_cast<std::uint64_t>(length) > most / samples)
      throw IoError(name + ": the header promises more than 2^40 samples");
    samples *= static_cast<std::uint64_t>(length);
  }
  const std::uint64_t bytes = samples * sample_size(layout.type);
  if (bytes > available)
    throw IoError(name + ": the file is truncated: its header promises " + std::to_string(bytes) +
                  " bytes of samples, it can hold " + std::to_string(available));
  if (bytes > std::numeric_limits<std::size_t>::max() / 2)
    throw IoError(name + ": the image is too large for a processor of 32 bits");
  return static_cast<std::size_t>(bytes);
}

std::size_t checked_deflated_bytes(const VolumeLayout& layout, std::uint64_t compressed, const std::string& name) {
  constexpr std::uint64_t largest_ratio = 1100;  // deflate's limit is 1032, see the zlib manual
  return checked_sample_bytes(layout, compressed * largest_ratio, name);
}

void set_axes(Grid& grid, const Eigen::Matrix3d& linear, const std::string& name) {
  if (!linear.allFinite() || !grid.origin.allFinite())
    throw IoError(name + ": the position of the image in space is not finite");
  for (int axis = 0; axis < 3; ++axis) {
    const double length = linear.col(axis).norm();
    grid.spacing(axis) = length > 0 ? length : 1;
    grid.direction.col(axis) = linear.col(axis) / grid.spacing(axis);
  }
  // A slice may lack its normal.
  if (linear.col(2).isZero(0) && grid.size[2] == 1)
    grid.direction.col(2) = Point<3>(grid.direction.col(0).cross(grid.direction.col(1))).normalized();
  constexpr double singular = 1e-6;  // volume of the unit axes: far below that of any real scan
  if (!(std::abs(grid.direction.determinant()) > singular))
    throw IoError(name + ": the axes of the image lie in one plane: its directions are singular");
}

}  // namespace csrbf
