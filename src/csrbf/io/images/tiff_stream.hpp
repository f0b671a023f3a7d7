#pragma once

#include <tiffio.h>

#include <string>

namespace csrbf {

/// Largest block of a TIFF file that is read, in bytes: a limit on damaged files.
inline constexpr std::size_t tiff_block_limit = std::size_t{1} << 30;

/// A TIFF file in memory. Messages of libtiff become the text of message(); it prints nothing.
class TiffStream {
 public:
  enum class Size { classic, big };

  /// Opens the bytes of a file for reading. Throws IoError.
  TiffStream(std::string bytes, const std::string& name);
  /// Starts a file. Throws IoError.
  TiffStream(Size size, const std::string& name);
  TiffStream(const TiffStream&) = delete;
  TiffStream& operator=(const TiffStream&) = delete;
  ~TiffStream();

  [[nodiscard]] TIFF* tiff() const { return tiff_; }
  [[nodiscard]] std::size_t size() const { return bytes_.size(); }
  /// The first error that libtiff reported.
  [[nodiscard]] const std::string& message() const { return message_; }
  /// Throws IoError with that message.
  [[noreturn]] void fail() const;
  /// Ends the file that was written and returns its bytes.
  [[nodiscard]] std::string finish();

 private:
  friend struct TiffCallbacks;
  void open(const char* mode);

  std::string bytes_;
  std::size_t position_ = 0;
  std::string name_;
  std::string message_;
  TIFF* tiff_ = nullptr;
};

}  // namespace csrbf
