#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <utility>

namespace csrbf::app {

/// malloc and free of the C library, bypassing those of the program. Throws std::bad_alloc.
void* system_malloc(std::size_t bytes);
void system_free(void* block) noexcept;

/// For containers that malloc itself needs.
template <class T>
struct SystemAllocator {
  using value_type = T;
  SystemAllocator() = default;
  template <class Other>
  explicit(false) SystemAllocator(const SystemAllocator<Other>& /*other*/) {}
  T* allocate(std::size_t n) { return static_cast<T*>(system_malloc(n * sizeof(T))); }
  void deallocate(T* p, std::size_t /*n*/) noexcept { system_free(p); }
  bool operator==(const SystemAllocator&) const = default;
};

/// Resident memory of the process; zero on systems without /proc.
class ResidentSet {
 public:
  ResidentSet();
  ResidentSet(const ResidentSet&) = delete;
  ResidentSet& operator=(const ResidentSet&) = delete;
  ~ResidentSet();

  [[nodiscard]] std::size_t bytes() const;

 private:
  int file_;
  std::size_t page_;
};

/// Large blocks of memory backed by unnamed files. Their pages can be evicted from the memory of the process and come
/// back on access; the files vanish with the process, however it ends. Disk space is reserved when a block is
/// allocated, so that a full disk fails the allocation and never an access.
class FileMemory {
 public:
  /// Bytes from which a block gets a file of its own; smaller: more files and system calls, larger: more memory that
  /// cannot be evicted. Chosen by hand.
  static constexpr std::size_t smallest = std::size_t{1} << 20;

  /// Keeps the memory of the process under `cap` bytes as long as the rest of it allows.
  FileMemory(std::string folder, std::size_t cap);

  /// A zeroed, page-aligned block; null when its file cannot be created.
  void* allocate(std::size_t bytes) noexcept;

  /// False when `block` is not one of these.
  bool release(void* block) noexcept;

  /// Bytes of a block; 0 when `block` is not one of these.
  [[nodiscard]] std::size_t size_of(const void* block) noexcept;

  /// Evicts pages, round-robin over all blocks, when `bytes` more would come near the cap. False when they still would
  /// after every block was evicted.
  bool make_room(std::size_t bytes);

  /// Bytes by which memory can grow before make_room has anything to do.
  [[nodiscard]] std::size_t room() const;

  /// Peak total size of the files.
  [[nodiscard]] std::size_t peak_bytes() const { return peak_bytes_; }

  /// Why the last failed allocation failed; empty when none did.
  [[nodiscard]] std::string failure();

 private:
  using Block = std::pair<const std::uintptr_t, std::size_t>;

  [[nodiscard]] std::size_t evict_chunk();

  std::string folder_;
  std::size_t cap_;
  std::atomic<std::size_t> headroom_;  // below the cap: what may be filled until the next check
  ResidentSet resident_;
  std::mutex mutex_;
  std::map<std::uintptr_t, std::size_t, std::less<>, SystemAllocator<Block>> blocks_;  // sizes by address
  std::uintptr_t hand_ = 0;                                                            // the next eviction
  std::size_t bytes_ = 0;
  std::atomic<std::size_t> peak_bytes_ = 0;
  std::size_t failed_bytes_ = 0;
  int failed_error_ = 0;
};

/// Whether malloc can take large blocks from a FileMemory: not with sanitizers or without the GNU C library.
bool file_memory_supported();

/// Makes malloc take large blocks from a FileMemory, from now to the end of the process.
FileMemory& use_file_memory(const std::string& folder, std::size_t cap);

/// Where malloc takes large blocks from; null: from the C library, as usual.
FileMemory* file_memory();

}  // namespace csrbf::app
