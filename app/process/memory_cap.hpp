#pragma once

#include "process/file_memory.hpp"

#include <cstddef>
#include <string>
#include <thread>

namespace csrbf::app {

/// Bytes of a size such as 2GB, 1500MB or 2GiB. Throws UsageError that names `flag`.
std::size_t parse_bytes(const std::string& text, const std::string& flag);

/// Keeps the memory of the process under a cap: large blocks come from files in a folder from now on, and a thread
/// gives their pages back to the system when memory gets short.
class MemoryCap {
 public:
  /// `scratch`: folder on a disk with room for what does not fit. Throws UsageError when the cap or the folder is
  /// unusable.
  MemoryCap(std::size_t bytes, const std::string& scratch);

  [[nodiscard]] std::size_t bytes() const { return bytes_; }
  [[nodiscard]] const std::string& scratch() const { return scratch_; }
  [[nodiscard]] std::size_t peak_scratch_bytes() const { return memory_.peak_bytes(); }

 private:
#ifndef __EMSCRIPTEN__  // whose library has no jthread
  void watch(const std::stop_token& stop);
#endif

  std::size_t bytes_;
  std::string scratch_;
  FileMemory& memory_;
#ifndef __EMSCRIPTEN__
  std::jthread watcher_;
#endif
};

}  // namespace csrbf::app
