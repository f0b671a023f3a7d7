#include "csrbf/io/images/formats.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/bytes.hpp"
#include "csrbf/io/files/text.hpp"

namespace csrbf {
namespace {

bool is_space(char c) {
  return c == ' ' || (c >= '\t' && c <= '\r');
}

// Walks over the words of a header or of ascii samples, which comments may interrupt.
class Words {
 public:
  Words(std::string_view text, const std::string& name) : text_(text), name_(name) {}

  std::int64_t integer(std::string_view what, std::int64_t lo, std::int64_t hi) {
    skip();
    const std::size_t begin = position_;
    while (position_ < text_.size() && !is_space(text_[position_]) && text_[position_] != '#') ++position_;
    if (begin == position_) throw IoError(place() + "the file ends before the " + std::string(what));
    const std::string_view word = text_.substr(begin, position_ - begin);
    const auto value = parse_integer(word);
    if (!value || *value < lo || *value > hi)
      throw IoError(place() + in_quotes(word) + " is not a " + std::string(what) + " from " + std::to_string(lo) +
                    " to " + std::to_string(hi));
    return *value;
  }
  [[nodiscard]] std::size_t position() const { return position_; }

 private:
  void skip() {
    while (position_ < text_.size() && (is_space(text_[position_]) || text_[position_] == '#')) {
      if (text_[position_] == '#')
        position_ = std::min(text_.find('\n', position_), text_.size());
      else
        line_ += text_[position_++] == '\n' ? 1 : 0;
    }
  }
  [[nodiscard]] std::string place() const { return name_ + ":" + std::to_string(line_) + ": "; }

  std::string_view text_;
  const std::string& name_;
  std::size_t position_ = 2;  // after the magic number
  Index line_ = 1;
};

}  // namespace

RawVolume parse_pnm(std::string bytes, const std::string& name) {
  const char kind = bytes.size() > 2 && bytes[0] == 'P' && is_space(bytes[2]) ? bytes[1] : '\0';
  if (kind != '2' && kind != '3' && kind != '5' && kind != '6')
    throw IoError(name + ": not a .pgm or .ppm file: it must begin with P2, P3, P5 or P6");
  constexpr std::int64_t longest = index_limit(std::int64_t{1} << 31);  // a limit on damaged files
  constexpr std::int64_t largest = 65535;                               // by the format
  Words words(bytes, name);
  RawVolume raw;
  raw.layout.grid.axes = 2;
  raw.layout.grid.size[0] = words.integer("width", 1, longest);
  raw.layout.grid.size[1] = words.integer("height", 1, longest);
  const std::int64_t maximum = words.integer("largest value", 1, largest);
  raw.layout.type = maximum > 255 ? SampleType::uint16 : SampleType::uint8;
  raw.layout.components = kind == '3' || kind == '6' ? 3 : 1;
  raw.order = std::endian::big;
  raw.offset = std::min(bytes.size(), words.position() + 1);
  const std::size_t left = bytes.size() - raw.offset;
  if (kind == '5' || kind == '6') {
    checked_sample_bytes(raw.layout, left, name);
    raw.bytes = std::move(bytes);
    return raw;
  }
  // An ascii sample takes a digit and a blank.
  checked_sample_bytes(raw.layout, (left + 1) / 2 * sample_size(raw.layout.type), name);
  raw.order = std::endian::little;
  raw.offset = 0;
  raw.bytes.reserve(raw.byte_count());
  for (std::size_t i = 0; i < raw.samples(); ++i) {
    const std::int64_t value = words.integer("sample", 0, maximum);
    if (raw.layout.type == SampleType::uint8)
      append_scalar(raw.bytes, static_cast<std::uint8_t>(value));
    else
      append_scalar(raw.bytes, static_cast<std::uint16_t>(value));
  }
  return raw;
}

FileParts format_pnm(const VolumeLayout& layout, std::string samples) {
  const bool wide = layout.type == SampleType::uint16;
  const std::string size = std::to_string(layout.grid.size[0]) + " " + std::to_string(layout.grid.size[1]);
  if (wide)
    for (std::size_t i = 0; i + 1 < samples.size(); i += 2) std::swap(samples[i], samples[i + 1]);
  return {std::string(layout.components == 3 ? "P6" : "P5") + "\n" + size + (wide ? "\n65535\n" : "\n255\n"),
          std::move(samples)};
}

}  // namespace csrbf
