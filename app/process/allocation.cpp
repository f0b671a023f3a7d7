// The program's malloc: that of the C library, with --memory a FileMemory for large blocks. Eigen and the containers of
// the standard library allocate all they hold here.

#include "process/file_memory.hpp"

#include "csrbf/core/simd.hpp"

#include <cerrno>
#include <cstdlib>
#include <new>

#if defined(__GLIBC__) && !defined(CSRBF_SANITIZED)
#define CSRBF_OWN_MALLOC
#include <dlfcn.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#endif

namespace csrbf::app {
namespace {

std::atomic<FileMemory*> in_use = nullptr;

}  // namespace

FileMemory* file_memory() {
  return in_use.load(std::memory_order_acquire);
}

// Never destroyed: the last blocks are freed after main.
FileMemory& use_file_memory(const std::string& folder, std::size_t cap) {
  auto* memory = new FileMemory(folder, cap);
  in_use.store(memory, std::memory_order_release);
  return *memory;
}

}  // namespace csrbf::app

#ifdef CSRBF_OWN_MALLOC

extern "C" {
// The internal names of glibc's malloc and its relatives.
// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming)
void* __libc_malloc(std::size_t bytes);
void* __libc_calloc(std::size_t count, std::size_t bytes);
void* __libc_realloc(void* block, std::size_t bytes);
void* __libc_memalign(std::size_t alignment, std::size_t bytes);
void __libc_free(void* block);
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)
}

namespace csrbf::app {

bool file_memory_supported() {
  return true;
}

namespace {

// The FileMemory that a block of this size comes from, if any.
FileMemory* home_of(std::size_t bytes) {
  return bytes < FileMemory::smallest ? nullptr : file_memory();
}

const std::size_t page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));

// Blocks in files are page-aligned, others hardly ever.
bool may_be_in_file(const void* block) {
  return file_memory() != nullptr && reinterpret_cast<std::uintptr_t>(block) % page == 0;
}

std::size_t usable_size(void* block) {
  using Function = std::size_t (*)(void*);
  static const auto of_library = reinterpret_cast<Function>(dlsym(RTLD_NEXT, "malloc_usable_size"));
  const std::size_t bytes = may_be_in_file(block) ? file_memory()->size_of(block) : 0;
  return bytes > 0 ? bytes : of_library(block);
}

}  // namespace
}  // namespace csrbf::app

using csrbf::app::file_memory;
using csrbf::app::FileMemory;

extern "C" {

void* malloc(std::size_t bytes) {
  FileMemory* memory = csrbf::app::home_of(bytes);
  return memory == nullptr ? __libc_malloc(bytes) : memory->allocate(bytes);
}

void free(void* block) {
  if (csrbf::app::may_be_in_file(block) && file_memory()->release(block)) return;
  __libc_free(block);
}

void* calloc(std::size_t count, std::size_t bytes) {
  std::size_t all = 0;
  if (__builtin_mul_overflow(count, bytes, &all)) {
    errno = ENOMEM;
    return nullptr;
  }
  FileMemory* memory = csrbf::app::home_of(all);
  return memory == nullptr ? __libc_calloc(count, bytes) : memory->allocate(all);
}

void* realloc(void* block, std::size_t bytes) {
  const bool is_in_file = csrbf::app::may_be_in_file(block) && file_memory()->size_of(block) > 0;
  if (!is_in_file && csrbf::app::home_of(bytes) == nullptr) return __libc_realloc(block, bytes);
  if (bytes == 0) {
    free(block);
    return nullptr;
  }
  void* moved = malloc(bytes);
  if (moved == nullptr || block == nullptr) return moved;
  std::memcpy(moved, block, std::min(bytes, csrbf::app::usable_size(block)));
  free(block);
  return moved;
}

void* memalign(std::size_t alignment, std::size_t bytes) {
  FileMemory* memory = alignment <= csrbf::app::page ? csrbf::app::home_of(bytes) : nullptr;
  return memory == nullptr ? __libc_memalign(alignment, bytes) : memory->allocate(bytes);
}

void* aligned_alloc(std::size_t alignment, std::size_t bytes) {
  return memalign(alignment, bytes);
}

int posix_memalign(void** block, std::size_t alignment, std::size_t bytes) {
  if (alignment % sizeof(void*) != 0 || (alignment & (alignment - 1)) != 0 || alignment == 0) return EINVAL;
  void* made = memalign(alignment, bytes);
  if (made == nullptr) return ENOMEM;
  *block = made;
  return 0;
}

std::size_t malloc_usable_size(void* block) {
  return block == nullptr ? 0 : csrbf::app::usable_size(block);
}
}

#define CSRBF_SYSTEM_MALLOC __libc_malloc
#define CSRBF_SYSTEM_FREE __libc_free
#else

namespace csrbf::app {

bool file_memory_supported() {
  return false;
}

}  // namespace csrbf::app

#define CSRBF_SYSTEM_MALLOC std::malloc
#define CSRBF_SYSTEM_FREE std::free
#endif

namespace csrbf::app {

void* system_malloc(std::size_t bytes) {
  void* block = CSRBF_SYSTEM_MALLOC(bytes);
  if (block == nullptr) throw std::bad_alloc();
  return block;
}

void system_free(void* block) noexcept {
  CSRBF_SYSTEM_FREE(block);
}

}  // namespace csrbf::app
