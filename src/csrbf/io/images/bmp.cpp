#include "csrbf/core/error.hpp"
#include "csrbf/io/images/formats.hpp"

namespace csrbf {
namespace {

constexpr std::size_t file_header = 14, least_header = 40;  // BITMAPINFOHEADER and its successors

// Rows are filled up to four bytes.
constexpr std::size_t row_bytes(std::size_t width, std::size_t bits) {
  return (width * bits + 31) / 32 * 4;
}

struct BmpHeader {
  std::size_t pixels = 0;  // where they begin
  std::size_t width = 0, height = 0, bits = 0;
  bool from_top = false;
  std::size_t palette = 0, colors = 0;  // where it begins, and its length
};

BmpHeader parse_header(std::string_view bytes, const std::string& name) {
  const auto fail = [&](const std::string& message) { throw IoError(name + ": " + message); };
  if (!bytes.starts_with("BM")) fail("not a BMP picture: it does not begin with BM");
  if (bytes.size() < file_header + least_header) fail("the file is truncated: its header has 54 bytes at least");
  const auto at = [&]<class T>(std::size_t place, T /*type*/) { return load_scalar<T>(bytes.data() + place); };
  const std::uint32_t size = at(file_header, std::uint32_t{});
  if (size < least_header) fail("BMP pictures of OS/2 are not supported; save it as .png");
  const std::int32_t width = at(18, std::int32_t{}), height = at(22, std::int32_t{});
  BmpHeader header;
  header.pixels = at(10, std::uint32_t{});
  header.bits = at(28, std::uint16_t{});
  const std::uint32_t compression = at(30, std::uint32_t{});
  constexpr std::uint32_t bit_fields = 3;
  if (compression != 0 && !(compression == bit_fields && header.bits == 32))
    fail("compressed BMP pictures are not supported; save it as .png");
  const std::size_t b = header.bits;
  if (b != 1 && b != 4 && b != 8 && b != 24 && b != 32)
    fail("BMP pictures of " + std::to_string(b) + " bits are not supported; 1, 4, 8, 24 and 32 are");
  constexpr std::int32_t most = 1 << 30;
  if (width <= 0 || height == 0 || height > most || height < -most) fail("the BMP picture has no pixels");
  header.width = static_cast<std::size_t>(width);
  header.from_top = height < 0;
  header.height = static_cast<std::size_t>(std::abs(height));
  if (b <= 8) {
    const std::uint32_t used = at(46, std::uint32_t{});
    header.colors = used == 0 ? std::size_t{1} << b : used;
    header.palette = file_header + size;
    if (header.colors > 256 || header.palette + 4 * header.colors > bytes.size()) fail("the palette is damaged");
  }
  const std::size_t row = row_bytes(header.width, b);
  if (header.pixels > bytes.size() || (bytes.size() - header.pixels) / row < header.height)
    fail("the file is truncated: it has no room for " + std::to_string(header.width) + " x " +
         std::to_string(header.height) + " pixels");
  return header;
}

bool is_grey(std::string_view palette) {
  for (std::size_t i = 0; i + 4 <= palette.size(); i += 4)
    if (palette[i] != palette[i + 1] || palette[i] != palette[i + 2]) return false;
  return true;
}

// The number that a pixel of at most 8 bits has in the palette.
std::size_t number_of(std::string_view row, std::size_t x, std::size_t bits) {
  const std::size_t per_byte = 8 / bits;
  const unsigned byte = static_cast<unsigned char>(row[x / per_byte]);
  const std::size_t shift = 8 - bits * (x % per_byte + 1);
  return (byte >> shift) & ((1U << bits) - 1);
}

}  // namespace

RawVolume parse_bmp(std::string_view bytes, const std::string& name) {
  const BmpHeader header = parse_header(bytes, name);
  const std::string_view palette = bytes.substr(header.palette, 4 * header.colors);
  RawVolume raw;
  VolumeLayout& layout = raw.layout;
  layout.type = SampleType::uint8;
  layout.components = header.bits <= 8 && is_grey(palette) ? 1 : 3;
  layout.grid.axes = 2;
  layout.grid.size = {static_cast<Index>(header.width), static_cast<Index>(header.height), 1};
  constexpr std::uint64_t largest_ratio = 3 * 8;  // of samples to pixels of one bit
  raw.bytes.resize(checked_sample_bytes(layout, largest_ratio * bytes.size(), name));
  const std::size_t row_size = row_bytes(header.width, header.bits);
  char* out = raw.bytes.data();
  for (std::size_t y = 0; y < header.height; ++y) {
    const std::size_t line = header.from_top ? y : header.height - 1 - y;
    const std::string_view row = bytes.substr(header.pixels + line * row_size, row_size);
    for (std::size_t x = 0; x < header.width; ++x) {
      std::string_view blue_green_red;
      if (header.bits > 8) {
        blue_green_red = row.substr(x * header.bits / 8);
      } else {
        const std::size_t number = number_of(row, x, header.bits);
        if (number >= header.colors) throw IoError(name + ": a pixel has a colour that the palette does not have");
        blue_green_red = palette.substr(4 * number);
      }
      for (Index c = layout.components - 1; c >= 0; --c) *out++ = blue_green_red[static_cast<std::size_t>(c)];
    }
  }
  return raw;
}

FileParts format_bmp(const VolumeLayout& layout, std::string_view samples) {
  const auto width = static_cast<std::size_t>(layout.grid.size[0]),
             height = static_cast<std::size_t>(layout.grid.size[1]);
  const std::size_t bits = layout.components == 1 ? 8 : 24, colors = layout.components == 1 ? 256 : 0;
  const std::size_t row = row_bytes(width, bits), begin = file_header + least_header + 4 * colors;
  FileParts parts;
  std::string& head = parts.head;
  head = "BM";
  append_scalar(head, static_cast<std::uint32_t>(begin + row * height));
  append_scalar(head, std::uint32_t{0});
  append_scalar(head, static_cast<std::uint32_t>(begin));
  append_scalar(head, static_cast<std::uint32_t>(least_header));
  append_scalar(head, static_cast<std::int32_t>(width));
  append_scalar(head, static_cast<std::int32_t>(height));
  append_scalar(head, std::uint16_t{1});  // planes
  append_scalar(head, static_cast<std::uint16_t>(bits));
  for (int i = 0; i < 6; ++i) append_scalar(head, std::uint32_t{0});  // compression, sizes, colours: the usual ones
  for (std::size_t grey = 0; grey < colors; ++grey) {
    head.append(3, static_cast<char>(grey));
    head += '\0';
  }
  parts.body.assign(row * height, '\0');
  const auto components = static_cast<std::size_t>(layout.components);
  for (std::size_t y = 0; y < height; ++y)
    for (std::size_t i = 0; i < width * components; ++i) {
      const std::size_t c = components - 1 - i % components;
      parts.body[(height - 1 - y) * row + i] = samples[y * width * components + i / components * components + c];
    }
  return parts;
}

}  // namespace csrbf
