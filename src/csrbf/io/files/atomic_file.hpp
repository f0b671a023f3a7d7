#pragma once

#include "csrbf/core/error.hpp"

#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

namespace csrbf {

/// A file cannot be written.
class OutputError : public IoError {
 public:
  using IoError::IoError;
};

/// A file that appears under its name only when it is complete: bytes go to a temporary file in the same folder, and
/// commit() renames it to the target. Without commit() the temporary is removed and the target stays as it was.
/// Devices and pipes are written directly; a symbolic link keeps pointing to the file that is replaced. A file without
/// permission to write is not replaced.
/// Every failure is an OutputError with the target and the system's reason.
class AtomicFile {
 public:
  explicit AtomicFile(const std::string& path);
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;
  ~AtomicFile();

  /// So many bytes will be written: a disk without room for them fails now, where the file system can tell.
  void reserve(std::uint64_t bytes);
  void write(std::string_view bytes);
  /// Takes the content of a complete file, without copying it where the file system can: the two are then one file, so
  /// that nothing may be written before or after.
  void take(const std::string& complete);
  void commit();

 private:
  [[noreturn]] void fail(const char* action) const;

  std::string path_;       // as the user wrote it, for messages
  std::string target_;     // with symbolic links resolved
  std::string temporary_;  // empty when the target is written directly or nothing is left to remove
  std::FILE* file_ = nullptr;
};

/// Writes a whole file through AtomicFile; "-" is standard output.
void write_file(const std::string& path, std::string_view bytes);

}  // namespace csrbf
