#include "process/peak_memory.hpp"

#ifdef _WIN32
#define NOMINMAX
#include <windows.h>
// after windows.h
#include <psapi.h>
#elif !defined(__EMSCRIPTEN__)
#include <sys/resource.h>
#endif

namespace csrbf::app {

std::size_t peak_memory_bytes() {
#ifdef _WIN32
  PROCESS_MEMORY_COUNTERS counters{};
  return GetProcessMemoryInfo(GetCurrentProcess(), &counters, sizeof counters) != 0 ? counters.PeakWorkingSetSize : 0;
#elif defined(__EMSCRIPTEN__)
  return __builtin_wasm_memory_size(0) * std::size_t{65536};  // it grows and is never returned
#else
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
#ifdef __APPLE__
  constexpr std::size_t bytes_per_unit = 1;
#else
  constexpr std::size_t bytes_per_unit = 1024;
#endif
  return static_cast<std::size_t>(usage.ru_maxrss) * bytes_per_unit;
#endif
}

}  // namespace csrbf::app
