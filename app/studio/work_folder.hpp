#pragma once

#include "common.hpp"

#include <exception>
#include <filesystem>
#include <map>
#include <set>

namespace csrbf::app {

/// A request that the studio does not fulfil, with the HTTP status that says why.
class Refused : public std::runtime_error {
 public:
  Refused(int status, const std::string& message) : std::runtime_error(message), status_(status) {}
  [[nodiscard]] int status() const { return status_; }

 private:
  int status_;
};

/// Any error as a refusal: 400 unless it is one already, 500 without memory.
Refused refusal_of(const std::exception_ptr& error);

/// The files that the studio works on: one flat folder, out of which no name leads. Files that were there before are
/// never overwritten or removed. Without a folder of the user it is a temporary one, removed in the end, in which the
/// files opened from elsewhere are links.
class WorkFolder {
 public:
  /// `folder`: of the user; empty: a temporary one. `files`: opened from the start. Throws UsageError for files that do
  /// not exist or are not in the user's folder.
  WorkFolder(const std::string& folder, const std::vector<std::string>& files);
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;
  ~WorkFolder();

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// Where previews run, beside it; results in it are the items "preview:NAME".
  [[nodiscard]] const std::filesystem::path& preview_path() const { return preview_; }
  [[nodiscard]] bool is_temporary() const { return is_temporary_; }

  /// A message with names of items in place of their paths.
  [[nodiscard]] std::string inside(std::string message) const;

  /// The path of an item that exists. Throws Refused 400 for names that lead elsewhere, 404 for unknown ones.
  [[nodiscard]] std::filesystem::path find(const std::string& name) const;

  /// The path for a new item: `name`, or with a number when that is taken. Throws Refused 400.
  std::filesystem::path fresh(const std::string& name);

  /// The path for an item that the page writes; replaces one that it wrote before. Throws Refused 400, 409.
  std::filesystem::path writable(const std::string& name);

  /// Throws Refused 400 when an argument of a command names anything outside the folder, 409 when a result would
  /// replace a file that was there before.
  void check(const std::vector<std::string>& arguments) const;

  /// Names and times of the files, in order to see later which ones a command wrote.
  using Snapshot = std::map<std::string, std::pair<std::filesystem::file_time_type, std::uintmax_t>>;
  [[nodiscard]] Snapshot snapshot(bool preview) const;
  /// Names of what was written since; they may be overwritten and removed from now on.
  std::vector<std::string> written_since(const Snapshot& before, bool preview);

  /// All items in the order in which they came.
  [[nodiscard]] std::vector<std::string> names() const;
  [[nodiscard]] bool is_made(const std::string& name) const { return made_.contains(name); }

  /// Takes back a name that fresh() gave.
  void forget(const std::string& name);

  /// Removes what a command or the page made; forgets anything else.
  void remove(const std::string& name);

 private:
  void check_argument(const std::string& argument) const;
  void keep(const std::string& name);

  std::filesystem::path path_, preview_, temporary_;
  bool is_temporary_ = true;
  std::vector<std::string> names_;
  std::set<std::string> made_;
};

/// A name without folders that is not hidden. Throws Refused 400.
const std::string& checked_name(const std::string& name);

}  // namespace csrbf::app
