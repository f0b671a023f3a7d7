#include "process/file_memory.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <system_error>

namespace csrbf::app {
namespace {

// Bytes evicted at a time; larger: fewer calls, smaller: less evicted in vain. Chosen by hand.
constexpr std::size_t chunk = std::size_t{8} << 20;
// Parts of the cap kept free at first (1/3) and at most (1/2): a larger headroom evicts sooner, a smaller one may be
// filled between two checks. Chosen by hand.
constexpr std::size_t headroom_share = 3, most_headroom_share = 2;
// Allocating a block makes room for at most this part (1/4) of the cap. Chosen by hand.
constexpr std::size_t announced_share = 4;

// Not every file system has unnamed files; elsewhere the file is unlinked at once.
int open_nameless(const std::string& folder) {
#ifdef O_TMPFILE
  const int file = open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, S_IRUSR | S_IWUSR);
  if (file >= 0 || (errno != EOPNOTSUPP && errno != EISDIR)) return file;
#endif
  std::string name = folder + "/.csrbf-memory-XXXXXX";
  const int named = mkostemp(name.data(), O_CLOEXEC);
  if (named >= 0) unlink(name.c_str());
  return named;
}

// A signal must not be mistaken for a full disk.
int reserve([[maybe_unused]] int file, [[maybe_unused]] std::size_t bytes) noexcept {
#ifdef __linux__
  int error = EINTR;
  while (error == EINTR) error = posix_fallocate(file, 0, static_cast<off_t>(bytes));
  return error;
#else
  return ENOTSUP;  // file_memory_supported() has excluded this
#endif
}

// Memory in a file of its own; null with errno.
void* map_file(const std::string& folder, std::size_t bytes) {
  const int file = open_nameless(folder);
  if (file < 0) return nullptr;
  int error = reserve(file, bytes);
  void* block = nullptr;
  if (error == 0) {
    block = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    if (block == MAP_FAILED) {
      block = nullptr;
      error = errno;
    }
  }
  close(file);
  errno = error;
  return block;
}

}  // namespace

ResidentSet::ResidentSet()
    : file_(open("/proc/self/statm", O_RDONLY | O_CLOEXEC)), page_(static_cast<std::size_t>(sysconf(_SC_PAGESIZE))) {}

ResidentSet::~ResidentSet() {
  close(file_);
}

std::size_t ResidentSet::bytes() const {
  std::array<char, 128> text{};
  const ssize_t length = pread(file_, text.data(), text.size(), 0);
  const char* end = text.data() + std::max<ssize_t>(0, length);
  const char* second = std::find<const char*>(text.data(), end, ' ');
  std::size_t pages = 0;
  if (second != end) std::from_chars(second + 1, end, pages);
  return pages * page_;
}

FileMemory::FileMemory(std::string folder, std::size_t cap)
    : folder_(std::move(folder)), cap_(cap), headroom_(cap / headroom_share) {}

// Most blocks are filled right after they are allocated.
void* FileMemory::allocate(std::size_t bytes) noexcept {
  make_room(std::min(bytes, cap_ / announced_share));
  void* block = map_file(folder_, bytes);
  const int error = errno;
  try {
    const std::lock_guard lock(mutex_);
    if (block != nullptr) {
      blocks_.emplace(reinterpret_cast<std::uintptr_t>(block), bytes);
      bytes_ += bytes;
      peak_bytes_ = std::max(peak_bytes_.load(), bytes_);
      return block;
    }
    failed_bytes_ = bytes;
    failed_error_ = error;
  } catch (const std::bad_alloc&) {
    munmap(block, bytes);
  }
  errno = ENOMEM;
  return nullptr;
}

bool FileMemory::release(void* block) noexcept {
  std::size_t bytes = 0;
  {
    const std::lock_guard lock(mutex_);
    const auto found = blocks_.find(reinterpret_cast<std::uintptr_t>(block));
    if (found == blocks_.end()) return false;
    bytes = found->second;
    blocks_.erase(found);
    bytes_ -= bytes;
  }
  munmap(block, bytes);
  return true;
}

std::size_t FileMemory::size_of(const void* block) noexcept {
  const std::lock_guard lock(mutex_);
  const auto found = blocks_.find(reinterpret_cast<std::uintptr_t>(block));
  return found == blocks_.end() ? 0 : found->second;
}

// Evicts the chunk at the clock hand, which moves on; returns its size.
std::size_t FileMemory::evict_chunk() {
  const std::lock_guard lock(mutex_);
  if (blocks_.empty()) return 0;
  auto block = blocks_.upper_bound(hand_);
  if (block != blocks_.begin() && hand_ < std::prev(block)->first + std::prev(block)->second) --block;
  if (block == blocks_.end()) block = blocks_.begin();
  const bool is_within = hand_ >= block->first && hand_ < block->first + block->second;
  const std::uintptr_t begin = is_within ? hand_ : block->first;
  const std::size_t bytes = std::min(chunk, block->first + block->second - begin);
  madvise(reinterpret_cast<void*>(begin), bytes, MADV_DONTNEED);  // NOLINT(performance-no-int-to-ptr)
  hand_ = begin + bytes;
  return bytes;
}

// On a busy machine checks can be far apart: the headroom grows with what was filled in between.
bool FileMemory::make_room(std::size_t bytes) {
  const std::size_t used = resident_.bytes(), high = cap_ - headroom_;
  if (used + bytes < high) return true;
  if (used > high) headroom_ = std::clamp(2 * (used - high), headroom_.load(), cap_ / most_headroom_share);
  const std::size_t low = high - headroom_ / 2;
  std::size_t all = 0;
  {
    const std::lock_guard lock(mutex_);
    all = bytes_;
  }
  for (std::size_t given = 0; given < all;) {
    const std::size_t size = evict_chunk();
    if (size == 0) break;
    given += size;
    if (resident_.bytes() + bytes < low) return true;
  }
  return false;
}

std::size_t FileMemory::room() const {
  const std::size_t used = resident_.bytes(), high = cap_ - headroom_;
  return used < high ? high - used : 0;
}

// The lock must not be held while text is built: its memory may come from here.
std::string FileMemory::failure() {
  std::size_t bytes = 0;
  int error = 0;
  {
    const std::lock_guard lock(mutex_);
    bytes = failed_bytes_;
    error = failed_error_;
  }
  if (error == 0) return "";
  constexpr std::size_t mega = 1000 * 1000;
  return "cannot keep a block of " + std::to_string(bytes / mega) + " MB in a file in " + folder_ + ": " +
         std::generic_category().message(error) + "; free space there, or choose another folder with --scratch";
}

}  // namespace csrbf::app
