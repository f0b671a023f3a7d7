#include "csrbf/io/images/tiff_stream.hpp"

#include "csrbf/core/error.hpp"

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstdio>
#include <cstring>

namespace csrbf {

struct TiffCallbacks {
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
  static toff_t size(thandle_t handle) { return stream(handle).bytes_.size(); }
  static int error(TIFF*, void* data, const char* module, const char* format, va_list arguments) {
    TiffStream& s = *static_cast<TiffStream*>(data);
    std::array<char, 256> text{};
    std::vsnprintf(text.data(), text.size(), format, arguments);
    if (s.message_.empty()) s.message_ = std::string(module != nullptr ? module : "libtiff") + ": " + text.data();
    return 1;
  }
  static int ignore(TIFF*, void*, const char*, const char*, va_list) { return 1; }
};

TiffStream::TiffStream(std::string bytes, const std::string& name) : bytes_(std::move(bytes)), name_(name) {
  if (!bytes_.starts_with(std::string_view("II*\0", 4)) && !bytes_.starts_with(std::string_view("MM\0*", 4)) &&
      !bytes_.starts_with(std::string_view("II+\0", 4)) && !bytes_.starts_with(std::string_view("MM\0+", 4)))
    throw IoError(name + ": not a TIFF file");
  open("rm");
}

TiffStream::TiffStream(Size size, const std::string& name) : name_(name) {
  open(size == Size::big ? "w8" : "w");
}

void TiffStream::open(const char* mode) {
  TIFFOpenOptions* options = TIFFOpenOptionsAlloc();
  if (options == nullptr) throw IoError(name_ + ": libtiff cannot start");
  TIFFOpenOptionsSetMaxSingleMemAlloc(options, tiff_block_limit);
  TIFFOpenOptionsSetErrorHandlerExtR(options, TiffCallbacks::error, this);
  TIFFOpenOptionsSetWarningHandlerExtR(options, TiffCallbacks::ignore, this);
  tiff_ = TIFFClientOpenExt(name_.c_str(), mode, this, TiffCallbacks::read, TiffCallbacks::write, TiffCallbacks::seek,
                            TiffCallbacks::close, TiffCallbacks::size, nullptr, nullptr, options);
  TIFFOpenOptionsFree(options);
  if (tiff_ == nullptr) fail();
}

TiffStream::~TiffStream() {
  if (tiff_ != nullptr) TIFFClose(tiff_);
}

void TiffStream::fail() const {
  throw IoError(name_ + ": " + (message_.empty() ? "libtiff gives no reason" : message_));
}

std::string TiffStream::finish() {
  TIFFClose(tiff_);
  tiff_ = nullptr;
  if (!message_.empty()) fail();
  return std::move(bytes_);
}

}  // namespace csrbf
