#include "csrbf/io/volume_stream.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/images/formats.hpp"

#include <filesystem>
#include <utility>

namespace csrbf {
namespace {

constexpr std::size_t head_bytes = 1 << 16;  // more than a header takes

std::optional<RawVolume> parse_head(const std::string& extension, std::string_view head, const std::string& name) {
  if (extension == ".npy") return parse_npy_volume_head(head, name);
  return parse_nifti_head(head, name);
}

}  // namespace

std::optional<VolumeStream> VolumeStream::open(const std::string& path) {
  const std::string extension = file_extension(path), name = display_name(path);
  if (extension != ".nii" && extension != ".npy") return std::nullopt;
  std::error_code error;
  if (!std::filesystem::is_regular_file(utf8_path(path), error)) return std::nullopt;
  OpenFile file(open_file(path, "rb"));
  if (!file) return std::nullopt;  // read_volume() says why
  std::string head(head_bytes, '\0');
  head.resize(std::fread(head.data(), 1, head.size(), file.get()));
  if (head.starts_with("\x1f\x8b")) return std::nullopt;
  std::optional<RawVolume> raw = parse_head(extension, head, name);
  if (!raw || raw->planar || raw->layout.components != 1 || raw->layout.frames != 1) return std::nullopt;
  const std::uint64_t size = std::filesystem::file_size(utf8_path(path), error);
  if (error) return std::nullopt;
  checked_sample_bytes(raw->layout, size - std::min<std::uint64_t>(size, raw->offset), name);
  const auto first = static_cast<std::int64_t>(std::exchange(raw->offset, 0));
  return VolumeStream(name, std::move(file), first, *std::move(raw));
}

std::span<const float> VolumeStream::read(Index begin, Index end) {
  const std::size_t slice = head_.byte_count() / static_cast<std::size_t>(head_.layout.grid.size[2]);
  const auto slices = static_cast<std::size_t>(end - begin);
  head_.bytes.resize(slices * slice);
  if (!seek_file(file_.get(), first_ + begin * static_cast<std::int64_t>(slice), SEEK_SET) ||
      std::fread(head_.bytes.data(), 1, head_.bytes.size(), file_.get()) != head_.bytes.size())
    throw IoError(path_ + ": the file ends within slice " + std::to_string(end) + ", or cannot be read");
  values_.resize(slices * slice / sample_size(head_.layout.type));
  decode_samples(head_, values_);
  return values_;
}

bool VolumeWriter::can_write(const std::string& path) {
  const std::string extension = file_extension(path);
  return path != "-" && (extension == ".nii" || extension == ".npy");
}

VolumeWriter::VolumeWriter(const std::string& path, const VolumeLayout& layout) : file_(path) {
  file_.write((file_extension(path) == ".npy" ? format_npy_volume(layout, {}) : format_nifti(layout, {})).head);
}

}  // namespace csrbf
