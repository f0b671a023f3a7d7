#include "csrbf/tiles/folder/tile_team.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/interruption.hpp"
#include "csrbf/io/files/atomic_file.hpp"
#include "csrbf/io/files/open_file.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/version.hpp"

#include <chrono>

#ifndef _WIN32
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>
#include <cerrno>
#endif

namespace csrbf {
namespace {

// Held by one process at a time, until it ends in whatever way. Nothing where the system has none.
class Lock {
 public:
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;
#ifdef _WIN32
  explicit Lock(const std::string& /*path*/) {}
  ~Lock() = default;
  [[nodiscard]] bool is_held_by_another() const {
    return false;
  }
#else
  explicit Lock(const std::string& path) : file_(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666)) {
    is_held_by_another_ = file_ >= 0 && ::flock(file_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  }
  ~Lock() {
    if (file_ >= 0) ::close(file_);
  }
  [[nodiscard]] bool is_held_by_another() const {
    return is_held_by_another_;
  }

 private:
  int file_;
  bool is_held_by_another_ = false;
#endif
};

constexpr const char* own_kind = "process";  // what a process writes about itself
constexpr std::size_t longest_message = 4000;
constexpr std::chrono::seconds late(10);  // how much later than the first process others start; chosen by hand

// When a file was written; before all others if it is not there.
std::filesystem::file_time_type written(const std::string& path) {
  std::error_code none;
  const auto time = std::filesystem::last_write_time(utf8_path(path), none);
  return none ? std::filesystem::file_time_type::min() : time;
}

// What a process has written into a file of its own; nothing if it is there no more.
std::string text_of(const std::string& path) {
  try {
    std::string text = read_file(path);
    text.erase(text.find_last_not_of(' ') + 1);
    return text;
  } catch (const IoError&) {
    return {};
  }
}

// What is thrown once the files of this process have gone.
SolverFailure emptied(const std::string& folder) {
  return SolverFailure(folder + ": has been emptied: another process has done the same work, or somebody removed it");
}

}  // namespace

TileTeam::TileTeam(const std::string& folder, const TileShare& share, Progress progress)
    : folder_((require(!folder.empty(), "tiles", "folder", folder, "must be named"), folder)),
      share_(share),
      progress_(std::move(progress)) {
  require(share.count >= 1 && share.rank >= 0 && share.rank < share.count, "tiles", "share", share.rank,
          "must be from 0 to the number of processes less one");
}

std::string TileTeam::failure() const {
  return folder_.file(own_kind + std::string("_failed"));
}

std::string TileTeam::own_file() const {
  return folder_.file(own_kind, share_.rank);
}

// A message from before this process started is one of an earlier run.
void TileTeam::check_others() const {
  report(progress_, "wait", 0);
  std::error_code none;
  const auto time = std::filesystem::last_write_time(utf8_path(failure()), none);
  if (!none && time >= started_) throw SolverFailure(text_of(failure()));
  if (!exists(own_file())) throw emptied(folder_.path());
  if (!work_.empty()) require_same_work();
}

void TileTeam::wait(const std::string& path) const {
  wait_until([&] { return exists(path); }, [this] { check_others(); });
}

void TileTeam::declare(const std::string& work) {
  work_ = work;
  (void)write_own(work);  // a process that cannot say it fails soon
}

// Of two processes the one that has started first sees the other, and tells it.
void TileTeam::require_same_work() const {
  for (const std::string& file : folder_.files(own_kind)) {
    if (file == failure() || !(written(file) > started_)) continue;
    const std::string declared = text_of(file);
    if (!declared.empty() && declared != work_)
      throw SolverFailure(folder_.path() +
                          ": another process works here with another input, other options, or as one of another "
                          "number; give all the same, and copies of the input the same time (cp -p)");
  }
}

void TileTeam::wait_for_all(const std::string& kind, Index count) const {
  for (Index i = 0; i < count; ++i) wait(folder_.file(kind, i));
}

Index TileTeam::for_own(const std::string& kind, Index count, const std::function<void(Index)>& make) const {
  Index found = 0;
  for (Index i = share_.rank; i < count; i += share_.count) {
    if (exists(folder_.file(kind, i)))
      ++found;
    else
      make(i);
  }
  return found;
}

Progress TileTeam::part_of(const char* stage, Index done, Index total) const {
  if (!progress_) return {};
  return [whole = progress_, stage, before = static_cast<double>(done), all = static_cast<double>(total)](
             std::string_view, double fraction) { return whole(stage, (before + fraction) / all); };
}

void TileTeam::run(const std::function<void()>& work) {
  const Lock lock(folder_.file(own_kind + std::string("_lock"), share_.rank));
  if (lock.is_held_by_another())
    throw SolverFailure(folder_.path() +
                        ": another process works here under the same number; to share the work, give each a "
                        "--tile-share of its own, for other work another folder");
  try {
    write_file(own_file(), std::string(longest_message, ' '));
    started_ = std::filesystem::last_write_time(utf8_path(own_file()));
    work();
  } catch (const Cancelled&) {
    throw;  // the same command goes on
  } catch (const std::exception& error) {
    const bool has_started = started_ != std::filesystem::file_time_type{};
    if (has_started && !exists(own_file())) throw emptied(folder_.path());
    if (share_.count > 1) tell(error.what());
    throw;
  }
}

void TileTeam::tell(const std::string& message) const {
  if (!write_own(message)) return;
  std::error_code ignored;
  std::filesystem::rename(utf8_path(own_file()), utf8_path(failure()), ignored);
}

// In place, for the disk may be full. Returns whether it was possible.
bool TileTeam::write_own(std::string text) const {
  text.resize(longest_message, ' ');
  const OpenFile file(open_file(own_file(), "r+b"));
  return file != nullptr && std::fwrite(text.data(), 1, text.size(), file.get()) == text.size() &&
         std::fflush(file.get()) == 0;
}

void TileTeam::clear() const {
  folder_.clear({own_kind, survey_kind});
}

void TileTeam::finish(const std::string& first) const {
  if (!leads()) wait(folder_.file("left", 0));  // else all that failed in writing start again, but one has left
  write_file(folder_.file("left", share_.rank), "");
  if (!leads()) return;
  for (Index rank = 1; rank < share_.count; ++rank) wait_until_left(rank);
  folder_.remove(first);
}

// The mark of a process may be that of an earlier run. Either it has started again, and leaves once more, or it has not
// yet, or never will, for its share was done.
void TileTeam::wait_until_left(Index rank) const {
  const auto asked = std::chrono::steady_clock::now();
  const std::string mark = folder_.file("left", rank);
  const auto has_left = [&] {
    if (!exists(mark)) return false;
    const auto left = written(mark);
    if (left >= started_) return true;
    return written(folder_.file(own_kind, rank)) <= left && std::chrono::steady_clock::now() - asked > late;
  };
  wait_until(has_left, [this] { check_others(); });
}

std::string tile_fingerprint(const std::string& input, const std::string& options) {
  const auto path = utf8_path(input);
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) throw IoError(input + ": must be a file, for it is read twice");
  // In 64 bits: libc++ counts in 128, which are no text.
  const auto changed =
      std::chrono::duration_cast<std::chrono::nanoseconds>(std::filesystem::last_write_time(path).time_since_epoch());
  return std::string("csrbf ") + CSRBF_VERSION + " size " + std::to_string(std::filesystem::file_size(path)) +
         " changed " + std::to_string(changed.count()) + " " + options;
}

void require_same_work(const std::string& found, const std::string& expected, const std::string& folder) {
  if (found != expected)
    throw InvalidInput("tiles: folder = " + folder + " has steps of other work (" + found + ", now " + expected +
                       "); remove it to start over, or name another");
}

}  // namespace csrbf
