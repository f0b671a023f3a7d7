#include "process/peak_memory.hpp"

#include <sys/resource.h>

namespace csrbf::app {

std::size_t peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
#ifdef __APPLE__
  constexpr std::size_t bytes_per_unit = 1;
#else
  constexpr std::size_t bytes_per_unit = 1024;
#endif
  return static_cast<std::size_t>(usage.ru_maxrss) * bytes_per_unit;
}

}  // namespace csrbf::app
