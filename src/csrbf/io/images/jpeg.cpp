#include "csrbf/core/error.hpp"
#include "csrbf/io/images/formats.hpp"

#ifdef CSRBF_HAS_JPEG
#include <csetjmp>
#include <cstdio>

#include <jpeglib.h>
#endif

namespace csrbf {

#ifdef CSRBF_HAS_JPEG
namespace {

// libjpeg leaves a function that fails by a jump to `back`: no object with a destructor may be made after setjmp().
struct JpegErrors {
  jpeg_error_mgr manager{};
  std::jmp_buf back{};
  std::array<char, JMSG_LENGTH_MAX> message{};
};

void leave(j_common_ptr info) {
  auto& errors = *reinterpret_cast<JpegErrors*>(info->err);
  info->err->format_message(info, errors.message.data());
  std::longjmp(errors.back, 1);
}

// Warnings, which have negative levels, are counted.
void count_warnings(j_common_ptr info, int level) {
  if (level < 0) ++info->err->num_warnings;
}

jpeg_error_mgr* start(JpegErrors& errors) {
  jpeg_error_mgr* const manager = jpeg_std_error(&errors.manager);
  manager->error_exit = leave;
  manager->emit_message = count_warnings;
  return manager;
}

// The reader, whose steps are apart because of the jumps.
class JpegReader {
 public:
  JpegReader(std::string_view bytes, std::string name) : name_(std::move(name)) {
    info_.err = start(errors_);
    if (setjmp(errors_.back) != 0) fail();
    jpeg_create_decompress(&info_);
    jpeg_mem_src(&info_, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
    jpeg_read_header(&info_, TRUE);
    if (info_.jpeg_color_space != JCS_GRAYSCALE) info_.out_color_space = JCS_RGB;
    jpeg_calc_output_dimensions(&info_);
  }
  JpegReader(const JpegReader&) = delete;
  JpegReader& operator=(const JpegReader&) = delete;
  ~JpegReader() { jpeg_destroy_decompress(&info_); }

  [[nodiscard]] const jpeg_decompress_struct& info() const { return info_; }

  void read(std::string& out) {
    if (setjmp(errors_.back) != 0) fail();
    jpeg_start_decompress(&info_);
    const std::size_t row = std::size_t{info_.output_width} * static_cast<std::size_t>(info_.output_components);
    while (info_.output_scanline < info_.output_height) {
      JSAMPROW line = reinterpret_cast<JSAMPROW>(out.data() + info_.output_scanline * row);
      jpeg_read_scanlines(&info_, &line, 1);
    }
    // libjpeg replaces missing data by grey and counts a warning.
    if (errors_.manager.num_warnings > 0) {
      std::snprintf(errors_.message.data(), errors_.message.size(), "its data are damaged or end too early");
      fail();
    }
    jpeg_finish_decompress(&info_);
  }

 private:
  [[noreturn]] void fail() {
    jpeg_destroy_decompress(&info_);
    throw IoError(name_ + ": the JPEG picture cannot be read: " + errors_.message.data());
  }

  std::string name_;
  JpegErrors errors_;
  jpeg_decompress_struct info_{};
};

}  // namespace

bool reads_jpeg() {
  return true;
}

RawVolume parse_jpeg(std::string_view bytes, const std::string& name) {
  if (!bytes.starts_with("\xFF\xD8")) throw IoError(name + ": not a JPEG picture");
  JpegReader reader(bytes, name);
  const jpeg_decompress_struct& info = reader.info();
  RawVolume raw;
  VolumeLayout& layout = raw.layout;
  layout.type = SampleType::uint8;
  layout.components = info.jpeg_color_space == JCS_GRAYSCALE ? 1 : 3;
  layout.grid.axes = 2;
  layout.grid.size = {Index{info.output_width}, Index{info.output_height}, 1};
  constexpr std::uint64_t largest_ratio = 4096;  // pixels of one colour take two bits per block of 64 at least
  raw.bytes.resize(checked_sample_bytes(layout, largest_ratio * bytes.size(), name));
  reader.read(raw.bytes);
  return raw;
}

FileParts format_jpeg(const VolumeLayout& layout, std::string_view samples, const std::string& name) {
  JpegErrors errors;
  jpeg_compress_struct info{};
  unsigned char* bytes = nullptr;
  unsigned long size = 0;  // NOLINT: the type of libjpeg
  info.err = start(errors);
  if (setjmp(errors.back) != 0) {
    jpeg_destroy_compress(&info);
    std::free(bytes);
    throw IoError(name + ": the JPEG picture cannot be written: " + errors.message.data());
  }
  jpeg_create_compress(&info);
  jpeg_mem_dest(&info, &bytes, &size);
  info.image_width = static_cast<JDIMENSION>(layout.grid.size[0]);
  info.image_height = static_cast<JDIMENSION>(layout.grid.size[1]);
  info.input_components = static_cast<int>(layout.components);
  info.in_color_space = layout.components == 1 ? JCS_GRAYSCALE : JCS_RGB;
  jpeg_set_defaults(&info);
  constexpr int quality = 95;  // of 100: no loss that one sees
  jpeg_set_quality(&info, quality, TRUE);
  jpeg_start_compress(&info, TRUE);
  const std::size_t row = samples.size() / static_cast<std::size_t>(layout.grid.size[1]);
  while (info.next_scanline < info.image_height) {
    auto* line = reinterpret_cast<JSAMPROW>(const_cast<char*>(samples.data() + info.next_scanline * row));
    jpeg_write_scanlines(&info, &line, 1);
  }
  jpeg_finish_compress(&info);
  jpeg_destroy_compress(&info);
  FileParts parts{std::string(reinterpret_cast<const char*>(bytes), size), {}};
  std::free(bytes);
  return parts;
}

#else

bool reads_jpeg() {
  return false;
}

RawVolume parse_jpeg(std::string_view bytes, const std::string& name) {
  if (!bytes.starts_with("\xFF\xD8")) throw IoError(name + ": not a JPEG picture");
  throw IoError(
      name + ": this build cannot read JPEG; convert the picture to .png, or build csrbf where libjpeg is installed");
}

FileParts format_jpeg(const VolumeLayout& /*layout*/, std::string_view /*samples*/, const std::string& name) {
  throw IoError(name + ": this build cannot write JPEG; write .png, or build csrbf where libjpeg is installed");
}

#endif

}  // namespace csrbf
