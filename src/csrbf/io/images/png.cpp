#include "csrbf/io/images/formats.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/interruption.hpp"

#include <png.h>

#include <csetjmp>
#include <cstring>

namespace csrbf {
namespace {

constexpr std::size_t signature = 8;
constexpr int wide = 16;

// What libpng's callbacks share with this code. libpng leaves by longjmp, over frames that own nothing.
struct Session {
  std::string_view input;
  std::string* output = nullptr;
  std::array<char, 128> message{};
};

extern "C" {

void fail_png(png_structp png, png_const_charp message) {
  auto& text = static_cast<Session*>(png_get_error_ptr(png))->message;
  std::strncpy(text.data(), message, text.size() - 1);
  png_longjmp(png, 1);
}

void ignore_png(png_structp, png_const_charp) {}

void read_png(png_structp png, png_bytep out, std::size_t size) {
  std::string_view& input = static_cast<Session*>(png_get_io_ptr(png))->input;
  if (size > input.size()) png_error(png, "the file is truncated");
  std::memcpy(out, input.data(), size);
  input.remove_prefix(size);
}

void write_png_bytes(png_structp png, png_bytep bytes, std::size_t size) {
  static_cast<Session*>(png_get_io_ptr(png))->output->append(reinterpret_cast<const char*>(bytes), size);
}

void flush_png(png_structp) {}

}  // extern "C"

// The two libpng objects for reading or writing.
class PngFile {
 public:
  PngFile(Session& session, bool writing)
      : writing_(writing),
        png(writing ? png_create_write_struct(PNG_LIBPNG_VER_STRING, &session, fail_png, ignore_png)
                    : png_create_read_struct(PNG_LIBPNG_VER_STRING, &session, fail_png, ignore_png)),
        info(png != nullptr ? png_create_info_struct(png) : nullptr) {
    if (info == nullptr) return;
    if (writing)
      png_set_write_fn(png, &session, write_png_bytes, flush_png);
    else
      png_set_read_fn(png, &session, read_png);
  }
  PngFile(const PngFile&) = delete;
  PngFile& operator=(const PngFile&) = delete;
  ~PngFile() {
    if (writing_)
      png_destroy_write_struct(&png, &info);
    else
      png_destroy_read_struct(&png, &info, nullptr);
  }
  [[nodiscard]] bool ready() const { return info != nullptr; }

 private:
  bool writing_;

 public:
  png_structp png;
  png_infop info;
};

bool read_header(PngFile& file) {
  if (setjmp(png_jmpbuf(file.png)) != 0) return false;
  png_read_info(file.png, file.info);
  if (png_get_color_type(file.png, file.info) == PNG_COLOR_TYPE_PALETTE) png_set_palette_to_rgb(file.png);
  png_set_packing(file.png);
  png_set_interlace_handling(file.png);
  png_read_update_info(file.png, file.info);
  return true;
}

bool read_rows(PngFile& file, png_uint_32 height, png_bytepp rows) {
  if (setjmp(png_jmpbuf(file.png)) != 0) return false;
  const int passes = png_set_interlace_handling(file.png);
  for (int pass = 0; pass < passes; ++pass)
    for (png_uint_32 y = 0; y < height; ++y) {
      stop_if_interrupted();
      png_read_row(file.png, rows[y], nullptr);
    }
  png_read_end(file.png, nullptr);
  return true;
}

bool write_rows(PngFile& file, png_uint_32 width, png_uint_32 height, int bits, int color_type, png_bytepp rows) {
  if (setjmp(png_jmpbuf(file.png)) != 0) return false;
  png_set_IHDR(file.png, file.info, width, height, bits, color_type, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  png_write_info(file.png, file.info);
  if (bits == wide) png_set_swap(file.png);
  for (png_uint_32 y = 0; y < height; ++y) {
    stop_if_interrupted();
    png_write_row(file.png, rows[y]);
  }
  png_write_end(file.png, nullptr);
  return true;
}

std::vector<png_bytep> row_pointers(png_bytep first, std::size_t stride, std::size_t height) {
  std::vector<png_bytep> rows(height);
  for (std::size_t y = 0; y < height; ++y) rows[y] = first + y * stride;
  return rows;
}

}  // namespace

RawVolume parse_png(const std::string& bytes, const std::string& name) {
  if (bytes.size() < signature || png_sig_cmp(reinterpret_cast<png_const_bytep>(bytes.data()), 0, signature) != 0)
    throw IoError(name + ": not a .png file");
  Session session{.input = bytes};
  PngFile file(session, false);
  if (!file.ready()) throw IoError(name + ": libpng cannot start");
  const auto fail = [&] { throw IoError(name + ": cannot read the picture: " + session.message.data()); };
  if (!read_header(file)) fail();

  RawVolume raw;
  Grid& grid = raw.layout.grid;
  grid.axes = 2;
  grid.size[0] = png_get_image_width(file.png, file.info);
  grid.size[1] = png_get_image_height(file.png, file.info);
  raw.layout.components = png_get_channels(file.png, file.info);
  raw.layout.type = png_get_bit_depth(file.png, file.info) == wide ? SampleType::uint16 : SampleType::uint8;
  raw.order = std::endian::big;
  // A packed sample takes one bit.
  raw.bytes.resize(checked_deflated_bytes(raw.layout, std::uint64_t{8} * bytes.size(), name));
  const std::size_t stride = png_get_rowbytes(file.png, file.info);
  if (stride * grid.size[1] != raw.bytes.size())
    throw IoError(name + ": the rows of the picture have an unexpected length");
  auto rows = row_pointers(reinterpret_cast<png_bytep>(raw.bytes.data()), stride, grid.size[1]);
  if (!read_rows(file, static_cast<png_uint_32>(grid.size[1]), rows.data())) fail();
  return raw;
}

FileParts format_png(const VolumeLayout& layout, std::string_view samples, const std::string& name) {
  constexpr std::array<int, 4> color_types{PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGB,
                                           PNG_COLOR_TYPE_RGB_ALPHA};
  const auto height = static_cast<std::size_t>(layout.grid.size[1]);
  FileParts parts;
  Session session{.input = {}, .output = &parts.head};
  PngFile file(session, true);
  if (!file.ready()) throw IoError(name + ": libpng cannot start");
  // libpng does not write to the rows it encodes.
  auto* first = reinterpret_cast<png_bytep>(const_cast<char*>(samples.data()));
  auto rows = row_pointers(first, samples.size() / height, height);
  const int bits = layout.type == SampleType::uint16 ? wide : 8;
  if (!write_rows(file, static_cast<png_uint_32>(layout.grid.size[0]), static_cast<png_uint_32>(height), bits,
                  color_types[layout.components - 1], rows.data()))
    throw IoError(name + ": cannot encode the picture: " + session.message.data());
  return parts;
}

}  // namespace csrbf
