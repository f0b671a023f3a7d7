#pragma once

#include "csrbf/core/types.hpp"

#include <functional>
#include <string>
#include <vector>

namespace csrbf {

/// The files of some work in a folder. A file has its name only when it is complete, so that whoever finds it can go on
/// from there: after an interruption, or in another process.
class TileFolder {
 public:
  /// Creates the folder if need be. Throws IoError.
  explicit TileFolder(std::string path);

  [[nodiscard]] const std::string& path() const { return path_; }
  /// Path of a file: `kind` of the whole work, or of one tile.
  [[nodiscard]] std::string file(const std::string& kind) const;
  [[nodiscard]] std::string file(const std::string& kind, Index tile) const;

  /// Paths of all complete files whose kinds begin so.
  [[nodiscard]] std::vector<std::string> files(const std::string& kind) const;

  /// Removes all files that this version writes, the one of this kind first, and the folder if nothing else is in it.
  void remove(const std::string& first) const;
  /// Removes those whose kinds do not begin with one of `kept`.
  void clear(const std::vector<std::string>& kept) const;

 private:
  std::string path_;
};

bool exists(const std::string& path);

/// Returns once `done`, asked now and then, is true. `check`, called in between, may throw.
void wait_until(const std::function<bool()>& done, const std::function<void()>& check);

}  // namespace csrbf
