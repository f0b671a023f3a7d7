#include "process/allocation.hpp"

#include <cstdlib>
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace csrbf::app {

void keep_freed_memory() {
#ifdef __GLIBC__
  constexpr int mapped_alone =
      32 << 20;  // bytes of the smallest array with a mapping of its own: the most that glibc takes
  constexpr int kept_at_most = 256 << 20;
  mallopt(M_MMAP_THRESHOLD, mapped_alone);
  mallopt(M_TRIM_THRESHOLD, kept_at_most);
#endif
}

}  // namespace csrbf::app
