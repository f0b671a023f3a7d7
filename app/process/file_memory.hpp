#pragma once

#include "process/resident_set.hpp"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <utility>

namespace csrbf::app {

/// The allocation functions of the C library, past those of the program. Throws std::bad_alloc.
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

/// Large blocks of memory that live in files without a name. Their pages can leave the memory of the process and come
/// back when they are used; the files vanish with the process, however it ends. Room on the disk is reserved when a
/// block is made, so that a full disk shows there and never at an access.
class FileMemory {
 public:
  /// Bytes from which on a block is worth a file.
  static constexpr std::size_t smallest = std::size_t{1} << 20;

  /// Keeps the memory of the process under `cap` bytes as long as the rest of it allows.
  FileMemory(std::string folder, std::size_t cap);

  /// A block of zeros that starts on a page; null when its file cannot be made.
  void* allocate(std::size_t bytes) noexcept;

  /// False when `block` is not one of these.
  bool release(void* block) noexcept;

  /// Bytes of a block; 0 when `block` is not one of these.
  [[nodiscard]] std::size_t size_of(const void* block) noexcept;

  /// Takes pages out of the memory of the process, in turns around all blocks, when `bytes` more would come near the
  /// cap. False when they still would after all had their turn.
  bool make_room(std::size_t bytes);

  /// Bytes that memory can grow before make_room has something to do.
  [[nodiscard]] std::size_t room() const;

  /// Largest sum of the sizes of all files.
  [[nodiscard]] std::size_t peak_bytes() const { return peak_bytes_; }

  /// Why the last block that could not be made could not; empty when all could.
  [[nodiscard]] std::string failure();

 private:
  using Block = std::pair<const std::uintptr_t, std::size_t>;

  [[nodiscard]] std::size_t give_back_chunk();

  std::string folder_;
  std::size_t cap_;
  std::atomic<std::size_t> headroom_;  // below the cap: what may be filled before anyone looks again
  ResidentSet resident_;
  std::mutex mutex_;
  std::map<std::uintptr_t, std::size_t, std::less<>, SystemAllocator<Block>> blocks_;  // sizes by address
  std::uintptr_t hand_ = 0;                                                            // whose turn it is
  std::size_t bytes_ = 0;
  std::atomic<std::size_t> peak_bytes_ = 0;
  std::size_t failed_bytes_ = 0;
  int failed_error_ = 0;
};

/// Whether malloc can take large blocks from a FileMemory: not with sanitizers, nor without the GNU C library.
bool file_memory_supported();

/// Makes malloc take large blocks from a FileMemory, from now to the end of the process.
FileMemory& use_file_memory(const std::string& folder, std::size_t cap);

/// What malloc takes large blocks from; null: from the C library, as always.
FileMemory* file_memory();

}  // namespace csrbf::app
