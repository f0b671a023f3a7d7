#pragma once

#include "csrbf/io/files/open_file.hpp"

#include <string_view>

namespace csrbf {

/// A part of a file that other processes write other parts of. The file must exist, and grows as needed.
/// Every failure is an IoError with the file and the system's reason.
class FilePart {
 public:
  /// From that byte on.
  FilePart(const std::string& path, std::int64_t begin);

  void write(std::string_view bytes);
  void close();

 private:
  [[noreturn]] void fail() const;

  std::string path_;
  OpenFile file_;
};

}  // namespace csrbf
