#include "csrbf/tiles/folder/tile_team.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/interruption.hpp"
#include "csrbf/io/files/atomic_file.hpp"
#include "csrbf/io/files/open_file.hpp"
#include "csrbf/version.hpp"

#include <chrono>
#include <filesystem>

namespace csrbf {

TileTeam::TileTeam(const std::string& folder, const TileShare& share, Progress progress)
    : folder_((require(!folder.empty(), "tiles", "folder", folder, "must be named"), folder)),
      share_(share),
      progress_(std::move(progress)) {
  require(share.count >= 1 && share.rank >= 0 && share.rank < share.count, "tiles", "share", share.rank,
          "must be from 0 to the number of processes less one");
}

void TileTeam::wait(const std::string& path) const {
  wait_for(path, failure(), [this] { report(progress_, "wait", 0); });
}

void TileTeam::wait_for_tiles(const std::string& kind, Index tiles) const {
  for (Index t = 0; t < tiles; ++t) wait(folder_.file(kind, t));
}

Index TileTeam::for_own_tiles(const std::string& kind, Index tiles, const std::function<void(Index)>& make) const {
  Index found = 0;
  for (Index t = share_.rank; t < tiles; t += share_.count) {
    if (exists(folder_.file(kind, t)))
      ++found;
    else
      make(t);
  }
  return found;
}

Progress TileTeam::part_of(const char* stage, Index done, Index total) const {
  if (!progress_) return {};
  return [whole = progress_, stage, before = static_cast<double>(done), all = static_cast<double>(total)](
             std::string_view, double fraction) { return whole(stage, (before + fraction) / all); };
}

void TileTeam::run(const std::function<void()>& work) const {
  try {
    if (leads()) {
      std::error_code ignored;
      std::filesystem::remove(utf8_path(failure()), ignored);
    }
    work();
  } catch (const Cancelled&) {
    throw;  // the same command goes on
  } catch (const std::exception& error) {
    if (share_.count > 1) write_file(failure(), error.what());
    throw;
  }
}

void TileTeam::finish() const {
  write_file(folder_.file("left", share_.rank), "");
  if (!leads()) return;
  for (Index p = 0; p < share_.count; ++p) wait(folder_.file("left", p));
  folder_.remove();
}

std::string tile_fingerprint(const std::string& input, const TileShare& share, const std::string& options) {
  const auto path = utf8_path(input);
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) throw IoError(input + ": must be a file, for it is read twice");
  // In 64 bits: libc++ counts in 128, which are no text.
  const auto changed =
      std::chrono::duration_cast<std::chrono::nanoseconds>(std::filesystem::last_write_time(path).time_since_epoch());
  return std::string("csrbf ") + CSRBF_VERSION + " size " + std::to_string(std::filesystem::file_size(path)) +
         " changed " + std::to_string(changed.count()) + " processes " + std::to_string(share.count) + " " + options;
}

void require_same_work(const std::string& found, const std::string& expected, const std::string& folder) {
  if (found != expected)
    throw InvalidInput("tiles: folder = " + folder + " has steps of other work (" + found + ", now " + expected +
                       "); remove it to start over, or name another");
}

}  // namespace csrbf
