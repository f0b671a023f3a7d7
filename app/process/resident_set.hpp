#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>

namespace csrbf::app {

/// Resident memory of the process; zero on systems without /proc.
class ResidentSet {
 public:
  ResidentSet() : file_(open("/proc/self/statm", O_RDONLY | O_CLOEXEC)) {}
  ResidentSet(const ResidentSet&) = delete;
  ResidentSet& operator=(const ResidentSet&) = delete;
  ~ResidentSet() { close(file_); }

  [[nodiscard]] std::size_t bytes() const {
    std::array<char, 128> text{};
    const ssize_t length = pread(file_, text.data(), text.size(), 0);
    const char* end = text.data() + std::max<ssize_t>(0, length);
    const char* second = std::find<const char*>(text.data(), end, ' ');
    std::size_t pages = 0;
    if (second != end) std::from_chars(second + 1, end, pages);
    return pages * page_;
  }

 private:
  int file_;
  std::size_t page_ = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
};

}  // namespace csrbf::app
