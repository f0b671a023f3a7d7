#pragma once

#include "csrbf/io/files/gzip_stream.hpp"
#include "csrbf/io/images/sample_codec.hpp"

namespace csrbf {

/// Reads an image some slices at a time, so that it may be larger than memory: .nii, .nii.gz and .npy, of one component
/// and one frame.
class VolumeStream {
 public:
  /// Nothing for images that read_volume() must read whole. Throws IoError as it does.
  static std::optional<VolumeStream> open(const std::string& path);

  [[nodiscard]] const VolumeLayout& layout() const { return layout_; }

  /// The slices [begin, end) along z, x fastest, until the next call. Throws IoError.
  std::span<const float> read(Index begin, Index end);
  /// The same to an array.
  void read(Index begin, Index end, std::span<double> to);

 private:
  VolumeStream(std::string path, OpenFile file, std::optional<GzipReader> gzip, std::int64_t first, RawVolume head)
      : path_(std::move(path)),
        file_(std::move(file)),
        gzip_(std::move(gzip)),
        first_(first),
        head_(std::move(head)),
        layout_(head_.layout) {
    layout_.type = value_type(head_);
  }

  void read_samples(Index begin, Index end);

  std::string path_;
  OpenFile file_;  // one of the two
  std::optional<GzipReader> gzip_;
  std::int64_t first_;   // byte of the samples
  RawVolume head_;       // and the samples read last
  VolumeLayout layout_;  // of the values
  std::vector<float> values_;
};

/// Writes an image of one component some slices at a time: .nii, .nii.gz and .npy, complete or not at all.
class VolumeWriter {
 public:
  /// Whether the extension is one of these.
  static bool can_write(const std::string& path);

  /// Samples are of layout.type. Throws OutputError, for a disk without room at once.
  VolumeWriter(const std::string& path, const VolumeLayout& layout);

  /// The next voxels, as little-endian samples.
  void write(std::string_view samples);

  /// After all of them: gives the file its name.
  void commit();

 private:
  AtomicFile file_;
  std::optional<GzipWriter> gzip_;
};

}  // namespace csrbf
