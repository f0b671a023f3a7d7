#include "process/memory_cap.hpp"

#include "common.hpp"

#include "csrbf/io/files/text.hpp"

#ifdef __linux__
#include <linux/magic.h>
#include <sys/vfs.h>
#endif
#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <sys/resource.h>

#include <cerrno>
#include <chrono>
#include <cmath>
#include <system_error>

namespace csrbf::app {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t mega = 1000 * 1000;
constexpr std::size_t least_cap = 64 * mega;  // the program, its threads and small blocks need some of it
constexpr double fill_rate = 8000;            // bytes per microsecond: faster than threads were observed to fill memory
// Between checks; longer: may notice growth too late, shorter: costs time. Chosen by hand.
constexpr auto shortest_wait = 500us, longest_wait = 20000us;

constexpr std::array<std::pair<const char*, double>, 6> units = {
    {{"MB", 1e6}, {"GB", 1e9}, {"TB", 1e12}, {"MiB", 1048576.0}, {"GiB", 1073741824.0}, {"TiB", 1099511627776.0}}};

bool is_in_memory(const std::string& folder) {
#ifdef __linux__
  struct statfs about {};
  return statfs(folder.c_str(), &about) == 0 && (about.f_type == TMPFS_MAGIC || about.f_type == RAMFS_MAGIC);
#else
  return false;
#endif
}

std::size_t checked_cap(std::size_t bytes) {
  if (!file_memory_supported())
    throw UsageError("--memory: this program was built without it; it needs the GNU C library and no sanitizers");
  if (bytes < least_cap)
    throw UsageError("--memory: " + std::to_string(bytes / mega) + " MB is too little; give at least " +
                     std::to_string(least_cap / mega) + "MB");
  return bytes;
}

const std::string& checked_scratch(const std::string& folder) {
  if (access(folder.c_str(), W_OK | X_OK) != 0)
    throw UsageError("--scratch " + folder + ": " + std::generic_category().message(errno) +
                     "; --memory needs a folder to write in");
  if (is_in_memory(folder))
    throw UsageError("--scratch " + folder +
                     ": this folder is kept in memory, which saves none; give a folder on a disk");
  return folder;
}

}  // namespace

std::size_t parse_bytes(const std::string& text, const std::string& flag) {
  const std::size_t end = text.find_first_not_of("0123456789.");
  const std::string unit = end == std::string::npos ? "" : text.substr(end);
  const auto known = std::find_if(units.begin(), units.end(), [&](const auto& u) { return unit == u.first; });
  const auto number = parse_number(text.substr(0, end));
  if (known == units.end() || !number || !(*number > 0))
    throw UsageError(flag + " " + text + ": expected a size such as 2GB, 1500MB or 2GiB");
  constexpr double most = 1e18;  // that fits the integer
  return static_cast<std::size_t>(std::min(most, *number * known->second));
}

MemoryCap::MemoryCap(std::size_t bytes, const std::string& scratch)
    : bytes_(checked_cap(bytes)),
      scratch_(checked_scratch(scratch)),
      memory_(use_file_memory(scratch_, bytes_)),
      watcher_([this](const std::stop_token& stop) { watch(stop); }) {}

// Checks more often the nearer the cap is: a thread that fills memory must not reach it in between.
void MemoryCap::watch(const std::stop_token& stop) {
#ifdef __linux__
  constexpr int urgent = -10;            // niceness, halfway to the highest priority
  setpriority(PRIO_PROCESS, 0, urgent);  // of this thread; fails without privileges, which does no harm
#endif
  while (!stop.stop_requested()) {
    std::chrono::microseconds wait = longest_wait;
    if (memory_.make_room(0)) {
      const std::chrono::microseconds to_fill(std::lround(static_cast<double>(memory_.room()) / fill_rate));
      wait = std::clamp<std::chrono::microseconds>(to_fill, shortest_wait, longest_wait);
    } else {
#ifdef __GLIBC__
      malloc_trim(0);  // the rest is in small blocks
#endif
    }
    std::this_thread::sleep_for(wait);
  }
}

}  // namespace csrbf::app
