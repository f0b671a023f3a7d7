#include "csrbf/io/images/formats.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/interruption.hpp"
#include "csrbf/io/images/geotiff.hpp"
#include "csrbf/io/images/tiff_pages.hpp"

#include <cstdarg>
#include <cstdio>

namespace csrbf {
namespace {

// A file in memory. Messages of libtiff become the text of message(); it prints nothing.
class TiffStream {
 public:
  // Opens the bytes of a file for reading.
  TiffStream(std::string bytes, const std::string& name) : bytes_(std::move(bytes)), name_(name) {
    if (!bytes_.starts_with(std::string_view("II*\0", 4)) && !bytes_.starts_with(std::string_view("MM\0*", 4)) &&
        !bytes_.starts_with(std::string_view("II+\0", 4)) && !bytes_.starts_with(std::string_view("MM\0+", 4)))
      throw IoError(name + ": not a TIFF file");
    open("rm");
  }
  // Starts a file.
  TiffStream(bool is_big, const std::string& name) : name_(name) { open(is_big ? "w8" : "w"); }
  TiffStream(const TiffStream&) = delete;
  TiffStream& operator=(const TiffStream&) = delete;
  ~TiffStream() {
    if (tiff_ != nullptr) TIFFClose(tiff_);
  }

  [[nodiscard]] TIFF* tiff() const { return tiff_; }
  [[nodiscard]] std::size_t size() const { return bytes_.size(); }
  // The first error that libtiff reported.
  [[nodiscard]] const std::string& message() const { return message_; }
  [[noreturn]] void fail() const {
    throw IoError(name_ + ": " + (message_.empty() ? "libtiff gives no reason" : message_));
  }
  // Ends the file that was written and returns its bytes.
  [[nodiscard]] std::string finish() {
    TIFFClose(tiff_);
    tiff_ = nullptr;
    if (!message_.empty()) fail();
    return std::move(bytes_);
  }

 private:
  void open(const char* mode) {
    TIFFOpenOptions* options = TIFFOpenOptionsAlloc();
    if (options == nullptr) throw IoError(name_ + ": libtiff cannot start");
    constexpr tmsize_t largest_block = tmsize_t{1} << 30;  // bytes, a limit on damaged files
    TIFFOpenOptionsSetMaxSingleMemAlloc(options, largest_block);
    TIFFOpenOptionsSetErrorHandlerExtR(options, error, this);
    TIFFOpenOptionsSetWarningHandlerExtR(options, ignore, this);
    tiff_ = TIFFClientOpenExt(name_.c_str(), mode, this, read, write, seek, close, size_of, nullptr, nullptr, options);
    TIFFOpenOptionsFree(options);
    if (tiff_ == nullptr) fail();
  }

  static TiffStream& stream(thandle_t handle) { return *static_cast<TiffStream*>(handle); }

  static tmsize_t read(thandle_t handle, void* out, tmsize_t size) {
    TiffStream& s = stream(handle);
    const std::size_t left = s.bytes_.size() - std::min(s.position_, s.bytes_.size());
    const std::size_t count = std::min(left, static_cast<std::size_t>(size));
    if (count > 0) std::memcpy(out, s.bytes_.data() + s.position_, count);
    s.position_ += count;
    return static_cast<tmsize_t>(count);
  }
  static tmsize_t write(thandle_t handle, void* bytes, tmsize_t size) {
    TiffStream& s = stream(handle);
    const std::size_t end = s.position_ + static_cast<std::size_t>(size);
    if (end > s.bytes_.size()) s.bytes_.resize(end);
    std::memcpy(s.bytes_.data() + s.position_, bytes, static_cast<std::size_t>(size));
    s.position_ = end;
    return size;
  }
  static toff_t seek(thandle_t handle, toff_t offset, int whence) {
    TiffStream& s = stream(handle);
    const std::size_t base = whence == SEEK_CUR ? s.position_ : whence == SEEK_END ? s.bytes_.size() : 0;
    s.position_ = base + offset;
    return s.position_;
  }
  static int close(thandle_t) { return 0; }
  static toff_t size_of(thandle_t handle) { return stream(handle).bytes_.size(); }
  static int error(TIFF*, void* data, const char* module, const char* format, va_list arguments) {
    TiffStream& s = *static_cast<TiffStream*>(data);
    std::array<char, 256> text{};
    std::vsnprintf(text.data(), text.size(), format, arguments);
    if (s.message_.empty()) s.message_ = std::string(module != nullptr ? module : "libtiff") + ": " + text.data();
    return 1;
  }
  static int ignore(TIFF*, void*, const char*, const char*, va_list) { return 1; }

  std::string bytes_;
  std::size_t position_ = 0;
  std::string name_;
  std::string message_;
  TIFF* tiff_ = nullptr;
};

struct Page {
  std::uint32_t width = 0, height = 0;
  std::uint16_t bits = 1, components = 1, format = SAMPLEFORMAT_UINT, planar = PLANARCONFIG_CONTIG,
                photometric = PHOTOMETRIC_MINISBLACK;

  bool operator==(const Page&) const = default;
};

Page read_page(TIFF* tiff) {
  Page page;
  TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &page.width);
  TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &page.height);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_BITSPERSAMPLE, &page.bits);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLESPERPIXEL, &page.components);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLEFORMAT, &page.format);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_PLANARCONFIG, &page.planar);
  TIFFGetField(tiff, TIFFTAG_PHOTOMETRIC, &page.photometric);
  return page;
}

int format_of(SampleType type) {
  if (is_floating(type)) return SAMPLEFORMAT_IEEEFP;
  return sample_name(type).starts_with("int") ? SAMPLEFORMAT_INT : SAMPLEFORMAT_UINT;
}

SampleType sample_type(const Page& page, const std::string& name) {
  const std::uint16_t format = page.format == SAMPLEFORMAT_VOID ? SAMPLEFORMAT_UINT : page.format;
  for (int t = 0; t <= static_cast<int>(SampleType::float64); ++t) {
    const auto type = static_cast<SampleType>(t);
    if (format == format_of(type) && page.bits == 8 * sample_size(type)) return type;
  }
  throw IoError(name + ": samples of " + std::to_string(page.bits) + " bits in TIFF sample format " +
                std::to_string(page.format) +
                " are not supported; integers of 8 to 64 bits and floats of 32 and 64 are");
}

// The part of a block of samples that lies within the page.
struct Block {
  const char* samples;
  std::uint32_t x, y, width, height;
  std::size_t stride;  // bytes of a row
};

class PageReader {
 public:
  // `limit`: largest size of a block.
  PageReader(TIFF* tiff, const Page& page, std::size_t sample, std::size_t limit, const std::string& name)
      : tiff_(tiff),
        page_(page),
        sample_(sample),
        planes_(page.planar == PLANARCONFIG_SEPARATE ? page.components : 1),
        in_block_(planes_ > 1 ? 1u : page.components),
        limit_(limit),
        name_(name) {}

  void read(char* out) const {
    const bool tiled = TIFFIsTiled(tiff_) != 0;
    std::uint32_t width = page_.width, height = page_.height;
    if (tiled) {
      TIFFGetField(tiff_, TIFFTAG_TILEWIDTH, &width);
      TIFFGetField(tiff_, TIFFTAG_TILELENGTH, &height);
    } else {
      TIFFGetFieldDefaulted(tiff_, TIFFTAG_ROWSPERSTRIP, &height);
      height = std::min(height, page_.height);
    }
    const tmsize_t size = tiled ? TIFFTileSize(tiff_) : TIFFStripSize(tiff_);
    const std::size_t stride = std::size_t{width} * in_block_ * sample_;
    // A tile may be larger than the page, but not larger than its compressed bytes can hold.
    if (width == 0 || height == 0 || size <= 0 || static_cast<std::size_t>(size) < stride * height ||
        static_cast<std::size_t>(size) > limit_)
      throw IoError(name_ + ": the blocks of the TIFF page have no valid size");
    std::vector<char> buffer(size);
    for (std::uint16_t plane = 0; plane < planes_; ++plane)
      for (std::uint64_t y = 0; y < page_.height; y += height)
        for (std::uint64_t x = 0; x < page_.width; x += width) {
          stop_if_interrupted();
          const auto column = static_cast<std::uint32_t>(x);
          const auto row = static_cast<std::uint32_t>(y);
          const tmsize_t done =
              tiled ? TIFFReadTile(tiff_, buffer.data(), column, row, 0, plane)
                    : TIFFReadEncodedStrip(tiff_, TIFFComputeStrip(tiff_, row, plane), buffer.data(), size);
          const Block block{
              buffer.data(), column, row, std::min(width, page_.width - column), std::min(height, page_.height - row),
              stride};
          if (done < 0 ||
              static_cast<std::size_t>(done) < stride * (block.height - 1) + block.width * in_block_ * sample_)
            return;
          copy(block, plane, out);
          ++blocks_;
        }
  }

  // True when read() got every block.
  [[nodiscard]] bool complete() const {
    return blocks_ == (TIFFIsTiled(tiff_) != 0 ? TIFFNumberOfTiles(tiff_) : TIFFNumberOfStrips(tiff_));
  }

 private:
  void copy(const Block& block, std::size_t plane, char* out) const {
    const std::size_t pixel = page_.components * sample_;
    const std::size_t piece = in_block_ * sample_;
    for (std::size_t y = 0; y < block.height; ++y) {
      const char* from = block.samples + y * block.stride;
      char* to = out + ((block.y + y) * page_.width + block.x) * pixel + plane * sample_;
      if (planes_ == 1)
        std::memcpy(to, from, block.width * pixel);
      else
        for (std::size_t x = 0; x < block.width; ++x) std::memcpy(to + x * pixel, from + x * piece, piece);
    }
  }

  TIFF* tiff_;
  const Page& page_;
  std::size_t sample_;
  std::uint16_t planes_;
  std::size_t in_block_;  // samples per pixel of a block
  std::size_t limit_;
  const std::string& name_;
  mutable std::uint32_t blocks_ = 0;
};

void check_colors(const Page& page, SampleType type, const std::string& name) {
  if (page.photometric == PHOTOMETRIC_PALETTE)
    throw IoError(name + ": TIFF palettes are not supported; save grey values or RGB");
  if (page.photometric != PHOTOMETRIC_MINISBLACK && page.photometric != PHOTOMETRIC_MINISWHITE &&
      page.photometric != PHOTOMETRIC_RGB)
    throw IoError(name + ": TIFF colours of photometric type " + std::to_string(page.photometric) +
                  " are not supported; save grey values or RGB");
  if (page.photometric == PHOTOMETRIC_MINISWHITE && type != SampleType::uint8 && type != SampleType::uint16)
    throw IoError(name + ": white at 0 is supported for 8 and 16 bits only");
}

// Pages are slices, unless the file says more.
TiffPages lay_out_pages(TIFF* tiff, Index pages, VolumeLayout& layout) {
  const std::optional<TiffPages> found = tiff_pages(tiff, pages, layout.components);
  if (!found) return {.slices = pages};
  layout.grid.axes = found->slices > 1 ? 3 : 2;
  layout.grid.size[2] = found->slices;
  layout.grid.spacing = found->spacing;
  layout.frames = found->frames;
  layout.components *= found->channels;
  return *found;
}

}  // namespace

RawVolume parse_tiff(std::string bytes, const std::string& name) {
  TiffStream stream(std::move(bytes), name);
  const Page page = read_page(stream.tiff());
  RawVolume raw;
  VolumeLayout& layout = raw.layout;
  layout.type = sample_type(page, name);
  check_colors(page, layout.type, name);
  const std::uint32_t pages = TIFFNumberOfDirectories(stream.tiff());
  if (!stream.message().empty()) stream.fail();  // the chain of pages is broken
  layout.grid.axes = pages > 1 ? 3 : 2;
  layout.grid.size = {static_cast<Index>(page.width), static_cast<Index>(page.height), static_cast<Index>(pages)};
  layout.components = page.components;
  const TiffPages order = lay_out_pages(stream.tiff(), pages, layout);
  read_geo_tags(stream.tiff(), raw, name);
  // LZW packs at most 4 kB into two bytes, deflate a little less.
  constexpr std::uint64_t largest_ratio = 2048;
  const std::uint64_t limit = stream.size() * largest_ratio;
  raw.bytes.resize(checked_sample_bytes(layout, limit, name));
  const std::size_t page_bytes = raw.bytes.size() / pages;
  std::vector<char> channel(order.channels > 1 ? page_bytes : 0);
  for (std::uint32_t i = 0; i < pages; ++i) {
    const std::string place = name + ": page " + std::to_string(i + 1) + " of " + std::to_string(pages);
    if (i > 0 && TIFFReadDirectory(stream.tiff()) == 0) throw IoError(place + ": " + stream.message());
    if (!(read_page(stream.tiff()) == page)) throw IoError(place + " differs from the first in size or type");
    const PageReader reader(stream.tiff(), page, sample_size(layout.type), limit, name);
    const TiffPages::Place at = order.place(i);
    char* const to =
        raw.bytes.data() + static_cast<std::size_t>((at.frame * order.slices + at.slice) * order.channels) * page_bytes;
    reader.read(channel.empty() ? to : channel.data());
    if (!reader.complete()) throw IoError(place + " cannot be read: " + stream.message());
    const std::size_t sample = sample_size(layout.type), step = sample * static_cast<std::size_t>(order.channels);
    for (std::size_t k = 0; k * sample < channel.size(); ++k)
      std::memcpy(to + k * step + sample * static_cast<std::size_t>(at.channel), &channel[k * sample], sample);
  }
  if (page.photometric == PHOTOMETRIC_MINISWHITE) {
    raw.slope = -1;
    raw.intercept = layout.type == SampleType::uint8 ? 255 : 65535;
  }
  return raw;
}

FileParts format_tiff(const VolumeLayout& layout, std::string_view samples, const std::string& name) {
  const Grid& grid = layout.grid;
  const auto pages = static_cast<std::size_t>(grid.size[2] * layout.frames);
  constexpr std::size_t classic_limit = std::size_t{4000} << 20;  // offsets have 32 bits; leaves room for tags
  TiffStream stream(samples.size() > classic_limit, name);
  TIFF* tiff = stream.tiff();
  const bool rgb = layout.components == 3 || layout.components == 4;
  const std::size_t height = grid.size[1], row_bytes = samples.size() / pages / height;
  constexpr std::size_t strip_bytes = std::size_t{1} << 20;  // larger: fewer strips, smaller: less memory to read one
  const std::size_t strip_rows = std::clamp<std::size_t>(strip_bytes / std::max<std::size_t>(row_bytes, 1), 1, height);
  for (std::size_t page = 0; page < pages; ++page) {
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, static_cast<std::uint32_t>(grid.size[0]));
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, static_cast<std::uint32_t>(grid.size[1]));
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, static_cast<int>(8 * sample_size(layout.type)));
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, static_cast<int>(layout.components));
    TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, format_of(layout.type));
    TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, rgb ? PHOTOMETRIC_RGB : PHOTOMETRIC_MINISBLACK);
    TIFFSetField(tiff, TIFFTAG_COMPRESSION, COMPRESSION_NONE);
    TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, static_cast<std::uint32_t>(strip_rows));
    const std::vector<std::uint16_t> extra(layout.components - (rgb ? 3 : 1), EXTRASAMPLE_UNSPECIFIED);
    if (!extra.empty()) TIFFSetField(tiff, TIFFTAG_EXTRASAMPLES, static_cast<int>(extra.size()), extra.data());
    write_geo_tags(tiff, layout, name);
    if (page == 0 && layout.frames > 1) TIFFSetField(tiff, TIFFTAG_IMAGEDESCRIPTION, frames_text(layout).c_str());
    const std::string_view of_page = samples.substr(page * (samples.size() / pages), samples.size() / pages);
    std::uint32_t strip = 0;
    for (std::size_t at = 0; at < of_page.size(); at += strip_rows * row_bytes, ++strip) {
      stop_if_interrupted();
      std::string part(of_page.substr(at, strip_rows * row_bytes));  // libtiff may swap bytes in place
      if (TIFFWriteEncodedStrip(tiff, strip, part.data(), static_cast<tmsize_t>(part.size())) < 0) stream.fail();
    }
    if (TIFFWriteDirectory(tiff) == 0) stream.fail();
  }
  return {stream.finish(), {}};
}

}  // namespace csrbf
