// What the files of this folder do on POSIX systems, as far as Windows has it; CMake compiles this one in their place.
#include "common.hpp"
#include "process/file_memory.hpp"
#include "process/interrupt.hpp"
#include "process/memory_cap.hpp"
#include "process/peak_memory.hpp"
#include "process/resume_log.hpp"

#define NOMINMAX
#include <windows.h>
// after windows.h
#include <psapi.h>

#include <csignal>
#include <cstdlib>
#include <new>

namespace csrbf::app {
namespace {

volatile std::sig_atomic_t received = 0;

constexpr int signal_base = 128;  // exit codes of shells: this + the number of the signal

// Windows forgets the handler when it calls it.
void handle(int signal) {
  if (received != 0) std::_Exit(signal_base + signal);
  received = signal;
  std::signal(signal, handle);
}

}  // namespace

void catch_interrupts() {
  std::signal(SIGINT, handle);
  std::signal(SIGTERM, handle);
}

bool interrupted() {
  return received != 0;
}

int interrupt_signal() {
  return received;
}

void interrupt_by(int signal) {
  received = signal;
}

int interrupt_exit_code() {
  return signal_base + (received != 0 ? received : SIGINT);
}

std::size_t peak_memory_bytes() {
  PROCESS_MEMORY_COUNTERS counters{};
  return GetProcessMemoryInfo(GetCurrentProcess(), &counters, sizeof counters) != 0 ? counters.PeakWorkingSetSize : 0;
}

std::size_t parse_bytes(const std::string& /*text*/, const std::string& flag) {
  throw UsageError(flag + ": only on Linux; without it, what does not fit in memory goes to the page file of Windows");
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
  throw UsageError("--resume: not on Windows; leave it out");
}

ResumeLog::~ResumeLog() = default;

void ResumeLog::share(const SharedWork& work) {
  work.compute_blocks(0, work.blocks());
}

void ResumeLog::remove() const {}

}  // namespace csrbf::app
