#include "csrbf/io/volume_stream.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/images/formats.hpp"

#include <array>
#include <filesystem>
#include <utility>

namespace csrbf {
namespace {

constexpr std::size_t head_bytes = 1 << 16;  // more than a header takes

std::string stream_extension(const std::string& path) {
  const std::string last = file_extension(path);
  return last == ".gz" ? file_extension(utf8_name(utf8_path(path).stem())) + last : last;
}

bool is_streamed(const std::string& extension) {
  return extension == ".nii" || extension == ".nii.gz" || extension == ".npy";
}

std::optional<RawVolume> parse_head(const std::string& extension, std::string_view head, const std::string& name) {
  if (extension == ".npy") return parse_npy_volume_head(head, name);
  return parse_nifti_head(head, name);
}

}  // namespace

std::optional<VolumeStream> VolumeStream::open(const std::string& path) {
  const std::string extension = stream_extension(path), name = display_name(path);
  if (!is_streamed(extension)) return std::nullopt;
  std::error_code error;
  if (!std::filesystem::is_regular_file(utf8_path(path), error)) return std::nullopt;
  OpenFile file(open_file(path, "rb"));
  if (!file) return std::nullopt;  // read_volume() says why
  const std::uint64_t size = std::filesystem::file_size(utf8_path(path), error);
  if (error) return std::nullopt;
  std::string head(head_bytes, '\0');
  head.resize(std::fread(head.data(), 1, head.size(), file.get()));
  std::optional<GzipReader> gzip;
  if (head.starts_with("\x1f\x8b")) {
    if (extension == ".npy") return std::nullopt;
    std::rewind(file.get());
    gzip.emplace(std::move(file), name);
    head.resize(head_bytes);
    head.resize(gzip->read(0, head));
  }
  std::optional<RawVolume> raw = parse_head(extension, head, name);
  if (!raw || raw->planar || raw->layout.components != 1 || raw->layout.frames != 1) return std::nullopt;
  if (gzip)
    checked_deflated_bytes(raw->layout, size, name);
  else
    checked_sample_bytes(raw->layout, size - std::min<std::uint64_t>(size, raw->offset), name);
  const auto first = static_cast<std::int64_t>(std::exchange(raw->offset, 0));
  return VolumeStream(name, std::move(file), std::move(gzip), first, *std::move(raw));
}

// The samples of the slices go to head_.bytes.
void VolumeStream::read_samples(Index begin, Index end) {
  const Index slices = head_.layout.grid.size[2];
  const std::size_t slice = head_.byte_count() / static_cast<std::size_t>(slices);
  head_.bytes.resize(static_cast<std::size_t>(end - begin) * slice);
  const std::int64_t from = first_ + begin * static_cast<std::int64_t>(slice);
  std::size_t count = 0;
  if (gzip_) {
    count = gzip_->read(static_cast<std::uint64_t>(from), head_.bytes);
    std::array<char, 1> more{};  // the checksum of the file is behind its last slice
    if (end == slices && count == head_.bytes.size())
      gzip_->read(static_cast<std::uint64_t>(from) + head_.bytes.size(), more);
  } else if (seek_file(file_.get(), from, SEEK_SET)) {
    count = std::fread(head_.bytes.data(), 1, head_.bytes.size(), file_.get());
  }
  if (count != head_.bytes.size())
    throw IoError(path_ + ": the file ends within slice " + std::to_string(end) + ", or cannot be read");
}

std::span<const float> VolumeStream::read(Index begin, Index end) {
  read_samples(begin, end);
  values_.resize(head_.bytes.size() / sample_size(head_.layout.type));
  decode_samples<float>(head_, values_);
  return values_;
}

void VolumeStream::read(Index begin, Index end, std::span<double> to) {
  read_samples(begin, end);
  decode_samples<double>(head_, to);
}

bool VolumeWriter::can_write(const std::string& path) {
  return path != "-" && is_streamed(stream_extension(path));
}

VolumeWriter::VolumeWriter(const std::string& path, const VolumeLayout& layout) : file_(path) {
  const std::string extension = stream_extension(path);
  const std::string head = (extension == ".npy" ? format_npy_volume(layout, {}) : format_nifti(layout, {})).head;
  if (extension == ".nii.gz")
    gzip_.emplace(file_);
  else
    file_.reserve(head.size() + static_cast<std::size_t>(layout.grid.voxels()) * sample_size(layout.type));
  write(head);
}

void VolumeWriter::write(std::string_view samples) {
  if (gzip_)
    gzip_->write(samples);
  else
    file_.write(samples);
}

void VolumeWriter::commit() {
  if (gzip_) gzip_->finish();
  file_.commit();
}

}  // namespace csrbf
