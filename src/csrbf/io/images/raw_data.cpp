#include "csrbf/io/images/raw_data.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/bytes.hpp"
#include "csrbf/io/files/deflate.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/files/text.hpp"

#include <filesystem>

namespace csrbf {
namespace {

std::size_t behind_lines(std::string_view bytes, std::size_t begin, std::int64_t lines, const std::string& name) {
  for (; lines > 0; --lines) {
    const std::size_t end = bytes.find('\n', begin);
    if (end == std::string_view::npos) throw IoError(name + ": the file ends within the lines to skip");
    begin = end + 1;
  }
  return begin;
}

void load_ascii(RawVolume& raw, std::string_view text, const std::string& name) {
  // A sample takes a digit and a separator.
  checked_sample_bytes(raw.layout, (text.size() + 1) / 2 * sample_size(raw.layout.type), name);
  std::string samples(raw.byte_count(), '\0');
  const auto is_digit = [](char c) { return static_cast<unsigned char>(c) > ' ' && c != ','; };
  std::size_t position = 0;
  with_sample_type(raw.layout.type, [&](auto type) {
    using T = decltype(type);
    for (std::size_t i = 0; i < raw.samples(); ++i) {
      while (position < text.size() && !is_digit(text[position])) ++position;
      const std::size_t begin = position;
      while (position < text.size() && is_digit(text[position])) ++position;
      const std::string_view word = text.substr(begin, position - begin);
      if (word.empty())
        throw IoError(name + ": the file is truncated: it holds " + std::to_string(i) + " of " +
                      std::to_string(raw.samples()) + " samples");
      const auto value = parse_number(word);
      if (!value)
        throw IoError(name + ": sample " + std::to_string(i + 1) + ": " + in_quotes(word) + " is not a number");
      store_scalar(samples.data() + i * sizeof(T), narrow_scalar<T>(*value));
    }
  });
  raw.bytes = std::move(samples);
  raw.offset = 0;
  raw.order = std::endian::little;
}

}  // namespace

void load_raw_data(RawVolume& raw, const RawData& data, std::string bytes, const std::string& path) {
  std::string name = display_name(path);
  std::size_t begin = data.begin;
  if (!data.file.empty()) {
    if (std::any_of(data.file.begin(), data.file.end(), [](char c) { return static_cast<unsigned char>(c) < ' '; }))
      throw IoError(name + ": the name of the data file, " + in_quotes(data.file) + ", holds control characters");
    name = (std::filesystem::path(path).parent_path() / data.file).string();
    // Devices and pipes may never end.
    std::error_code error;
    if (std::filesystem::exists(name, error) && !std::filesystem::is_regular_file(name, error))
      throw IoError(name + ": the data of an image must be in a regular file");
    bytes = read_file(name);
    begin = 0;
  }
  begin = behind_lines(bytes, begin, data.skip_lines, name);
  const std::size_t left = bytes.size() - begin;
  const std::string_view rest = std::string_view(bytes).substr(begin);
  if (data.encoding == RawData::Encoding::ascii) {
    load_ascii(raw, rest, name);
    return;
  }
  const bool to_end = data.skip_bytes < 0;
  if (data.encoding == RawData::Encoding::deflate) {
    if (to_end) throw IoError(name + ": compressed data cannot be counted from their end");
    const std::size_t size = checked_deflated_bytes(raw.layout, left, name);
    const auto skipped = static_cast<std::size_t>(data.skip_bytes);
    if (skipped / 1100 > left) throw IoError(name + ": the bytes to skip lie beyond the end of the file");
    raw.bytes = inflate_bytes(rest, skipped + size, name);
    raw.offset = skipped;
    return;
  }
  const std::size_t skipped = to_end ? 0 : std::min(left, static_cast<std::size_t>(data.skip_bytes));
  const std::size_t size = checked_sample_bytes(raw.layout, left - skipped, name);
  raw.offset = to_end ? bytes.size() - size : begin + skipped;
  raw.bytes = std::move(bytes);
}

}  // namespace csrbf
