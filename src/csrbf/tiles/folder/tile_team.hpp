#pragma once

#include "csrbf/core/progress.hpp"
#include "csrbf/tiles/folder/tile_folder.hpp"
#include "csrbf/tiles/tile_share.hpp"

#include <filesystem>

namespace csrbf {

/// The kind of files that processes make before the work has started.
inline constexpr const char* survey_kind = "survey";

/// One process of those that share the work in a folder: tiles are dealt to them in turn, and each waits for the files
/// that it needs of others.
class TileTeam {
 public:
  /// Throws InvalidInput for a share that is none.
  TileTeam(const std::string& folder, const TileShare& share, Progress progress);

  [[nodiscard]] const TileFolder& folder() const { return folder_; }
  [[nodiscard]] Index rank() const { return share_.rank; }
  [[nodiscard]] Index processes() const { return share_.count; }
  [[nodiscard]] bool leads() const { return share_.rank == 0; }
  [[nodiscard]] const Progress& progress() const { return progress_; }

  /// Returns once the file is there. Throws SolverFailure when another process gave up, or does other work.
  void wait(const std::string& path) const;
  /// For the files of a kind with the numbers 0, 1, ...
  void wait_for_all(const std::string& kind, Index count) const;

  /// Calls make(number) for the own of so many files of a kind that are missing, in turn those of each process; returns
  /// how many are there.
  Index for_own(const std::string& kind, Index count, const std::function<void(Index)>& make) const;

  /// Progress of step `done` of `total` in a stage.
  [[nodiscard]] Progress part_of(const char* stage, Index done, Index total) const;

  /// Does the work; when that fails, the others are told, and fail as well.
  void run(const std::function<void()>& work);

  /// Says which work this process does, in a word. From here on, waiting ends when a process that has started later
  /// does other work: the two would wait for each other.
  void declare(const std::string& work);

  /// For the leading process when it starts the work: removes steps of earlier work that were left behind.
  void clear() const;

  /// Waits until all processes have come here; the leading one then removes the files, that of this kind first.
  void finish(const std::string& first) const;

 private:
  [[nodiscard]] std::string failure() const;
  [[nodiscard]] std::string own_file() const;
  void check_others() const;
  void require_same_work() const;
  void wait_until_left(Index rank) const;
  void tell(const std::string& message) const;
  [[nodiscard]] bool write_own(std::string text) const;

  TileFolder folder_;
  TileShare share_;
  Progress progress_;
  std::string work_;                              // as declared
  std::filesystem::file_time_type started_ = {};  // by the clock of the folder
};

/// What tells whether the steps in a folder belong to this version, this input and these options.
std::string tile_fingerprint(const std::string& input, const std::string& options);

/// Throws InvalidInput when the steps in a folder are of other work.
void require_same_work(const std::string& found, const std::string& expected, const std::string& folder);

}  // namespace csrbf
