#include "csrbf/io/files/discard_bytes.hpp"

#ifdef __linux__
#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#endif

namespace csrbf {

void discard_bytes([[maybe_unused]] char* begin, [[maybe_unused]] char* end) {
#ifdef __linux__
  const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  const std::size_t ahead = (page - reinterpret_cast<std::uintptr_t>(begin) % page) % page;
  const auto bytes = static_cast<std::size_t>(end - begin);
  if (bytes < ahead + page) return;
  madvise(begin + ahead, (bytes - ahead) / page * page, MADV_DONTNEED);
#endif
}

}  // namespace csrbf
