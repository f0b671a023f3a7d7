// What the files of this folder that need mapped files do, as far as Windows and WebAssembly have it; CMake compiles
// this one in their place.
#include "common.hpp"
#include "process/file_memory.hpp"
#include "process/memory_cap.hpp"
#include "process/peak_memory.hpp"
#include "process/resume_log.hpp"

#include <cstdlib>
#include <new>

#ifdef _WIN32
#define NOMINMAX
#include <windows.h>
// after windows.h
#include <psapi.h>
#endif

namespace csrbf::app {

#ifdef _WIN32
std::size_t peak_memory_bytes() {
  PROCESS_MEMORY_COUNTERS counters{};
  return GetProcessMemoryInfo(GetCurrentProcess(), &counters, sizeof counters) != 0 ? counters.PeakWorkingSetSize : 0;
}
#else
// Memory of WebAssembly grows and is never returned.
std::size_t peak_memory_bytes() {
  return __builtin_wasm_memory_size(0) * std::size_t{65536};
}
#endif

std::size_t parse_bytes(const std::string& /*text*/, const std::string& flag) {
  if (flag != "--memory") return 0;  // of the studio, which refuses to start
  throw UsageError(flag + ": only on Linux; leave it out");
}

MemoryCap::MemoryCap(std::size_t bytes, const std::string& scratch)
    : bytes_(bytes), scratch_(scratch), memory_(use_file_memory(scratch, bytes)) {}

ResidentSet::ResidentSet() : file_(-1), page_(0) {}

ResidentSet::~ResidentSet() = default;

void* system_malloc(std::size_t bytes) {
  void* block = std::malloc(bytes);
  if (block == nullptr) throw std::bad_alloc();
  return block;
}

void system_free(void* block) noexcept {
  std::free(block);
}

std::string FileMemory::failure() {
  return "";
}

bool file_memory_supported() {
  return false;
}

FileMemory& use_file_memory(const std::string& /*folder*/, std::size_t /*cap*/) {
  throw UsageError("--memory: only on Linux");
}

FileMemory* file_memory() {
  return nullptr;
}

std::uint64_t fingerprint(const std::string& /*path*/) {
  return 0;
}

ResumeLog::ResumeLog(const std::string& path, const std::string& /*key*/) : path_(path), file_(-1) {
  throw UsageError("--resume: neither on Windows nor in a browser; leave it out");
}

ResumeLog::~ResumeLog() = default;

void ResumeLog::share(const SharedWork& work) {
  work.compute_blocks(0, work.blocks());
}

void ResumeLog::remove() const {}

}  // namespace csrbf::app
