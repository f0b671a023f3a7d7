#pragma once

#include "csrbf/core/types.hpp"

#include <functional>
#include <string>

namespace csrbf {

/// The files of some work in a folder. A file has its name only when it is complete, so that whoever finds it can go on
/// from there: after an interruption, or in another process.
class TileFolder {
 public:
  /// Creates the folder if need be. Throws IoError.
  explicit TileFolder(std::string path);

  /// Path of a file: `kind` of the whole work, or of one tile.
  [[nodiscard]] std::string file(const std::string& kind) const;
  [[nodiscard]] std::string file(const std::string& kind, Index tile) const;

  /// Removes all files that this version writes, and the folder if nothing else is in it.
  void remove() const;

 private:
  std::string path_;
};

bool exists(const std::string& path);

/// Returns once `path` exists. Throws Cancelled when `alive`, called now and then, does; SolverFailure with its text
/// when the file `failure` appears: another process gave up.
void wait_for(const std::string& path, const std::string& failure, const std::function<void()>& alive);

}  // namespace csrbf
