#include "studio/work_folder.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <new>

namespace csrbf::app {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view preview_prefix = "preview:";

// Flags whose files are written.
constexpr std::array outputs{"-o", "--output", "--model", "--contour", "--preview", "--table", "--ridges", "--report"};

fs::path make_temporary() {
  std::string form = (fs::temp_directory_path() / "csrbf-studio-XXXXXX").string();
  if (mkdtemp(form.data()) == nullptr) throw UsageError("no temporary folder can be made: " + form);
  return form;
}

bool is_within(const fs::path& path, const fs::path& folder) {
  const auto [end, rest] = std::mismatch(folder.begin(), folder.end(), path.begin(), path.end());
  return end == folder.end();
}

[[noreturn]] void refuse_outside(const std::string& argument) {
  throw Refused(400, "\"" + argument + "\" leads out of the studio's folder; give the name of a file in it");
}

// Of a file in a folder that a command made: "beat/labels_0003.png".
const std::string& checked_path(const std::string& name) {
  const std::size_t slash = name.find('/');
  if (slash == std::string::npos) return checked_name(name);
  checked_name(name.substr(0, slash));
  checked_name(name.substr(slash + 1));
  return name;
}

// The first part of a name, and its extensions: "scan.nii.gz" is "scan" and ".nii.gz".
std::pair<std::string, std::string> split_name(const std::string& name) {
  const std::size_t dot = name.find('.');
  return {name.substr(0, dot), dot == std::string::npos ? "" : name.substr(dot)};
}

}  // namespace

Refused refusal_of(const std::exception_ptr& error) {
  constexpr int bad = 400, unknown = 500;
  try {
    std::rethrow_exception(error);
  } catch (const Refused& refused) {
    return refused;
  } catch (const std::bad_alloc&) {
    return {unknown, "not enough memory"};
  } catch (const std::exception& failure) {
    return {bad, failure.what()};
  }
}

const std::string& checked_name(const std::string& name) {
  constexpr std::size_t longest = 200;  // file systems allow 255 bytes, and temporary names are longer
  const bool is_plain = !name.empty() && name.size() <= longest && name.front() != '.' && name.front() != '-' &&
                        std::none_of(name.begin(), name.end(), [](unsigned char c) {
                          return c < ' ' || c == '/' || c == '\\' || c == ':' || c == 127;
                        });
  if (!is_plain) throw Refused(400, "\"" + name + "\" is not the name of a file in the studio's folder");
  return name;
}

WorkFolder::WorkFolder(const std::string& folder, const std::vector<std::string>& files) {
  std::error_code error;
  if (!folder.empty()) {
    path_ = fs::canonical(folder, error);
    if (error || !fs::is_directory(path_)) throw UsageError("--folder " + folder + ": no such folder");
    is_temporary_ = false;
  }
  std::vector<fs::path> given;
  for (const std::string& file : files) {
    given.push_back(fs::canonical(file, error));
    if (error || !fs::is_regular_file(given.back())) throw UsageError(file + ": no such file");
    if (!is_temporary_ && given.back().parent_path() != path_)
      throw UsageError(file + " is not in --folder " + folder + "; copy it there, or leave out --folder");
  }
  temporary_ = make_temporary();
  preview_ = temporary_ / "preview";
  fs::create_directory(preview_);
  if (is_temporary_) {
    path_ = fs::canonical(temporary_) / "work";
    fs::create_directory(path_);
    for (const fs::path& file : given) {
      const std::string name = checked_name(file.filename().string());
      if (!fs::exists(path_ / name)) fs::create_symlink(file, path_ / name);
      keep(name);
    }
  } else {
    std::vector<std::string> all;
    for (const fs::directory_entry& entry : fs::directory_iterator(path_, error))
      if (entry.is_regular_file(error) && !entry.path().filename().string().starts_with('.') &&
          is_within(fs::canonical(entry.path(), error), path_))
        all.push_back(entry.path().filename().string());
    std::sort(all.begin(), all.end());
    for (const fs::path& file : given) keep(file.filename().string());
    for (const std::string& name : all) keep(name);
  }
}

WorkFolder::~WorkFolder() {
  std::error_code error;
  fs::remove_all(temporary_, error);
}

void WorkFolder::keep(const std::string& name) {
  if (std::find(names_.begin(), names_.end(), name) == names_.end()) names_.push_back(name);
}

std::string WorkFolder::inside(std::string message) const {
  const std::string prefix = path_.string() + "/";
  for (std::size_t at = message.find(prefix); at != std::string::npos; at = message.find(prefix, at))
    message.erase(at, prefix.size());
  return message;
}

fs::path WorkFolder::find(const std::string& name) const {
  const bool is_preview = name.starts_with(preview_prefix);
  const std::string plain = is_preview ? name.substr(preview_prefix.size()) : name;
  checked_path(plain);
  if (!is_preview && std::find(names_.begin(), names_.end(), plain) == names_.end())
    throw Refused(404, "there is no \"" + name + "\" in the studio");
  const fs::path path = (is_preview ? preview_ : path_) / plain;
  std::error_code error;
  if (!fs::is_regular_file(path, error)) throw Refused(404, "there is no \"" + name + "\" in the studio");
  if (!is_temporary_ && !is_preview && !is_within(fs::canonical(path, error), path_)) refuse_outside(name);
  return path;
}

fs::path WorkFolder::fresh(const std::string& name) {
  const auto [stem, extensions] = split_name(checked_name(name));
  std::string free = name;
  for (int i = 2; fs::exists(fs::symlink_status(path_ / free)); ++i) free = stem + "-" + std::to_string(i) + extensions;
  keep(free);
  made_.insert(free);
  return path_ / free;
}

fs::path WorkFolder::writable(const std::string& name) {
  checked_name(name);
  if (!fs::exists(fs::symlink_status(path_ / name))) return fresh(name);
  if (!is_made(name)) throw Refused(409, "\"" + name + "\" was there before and is not replaced; take another name");
  return path_ / name;
}

// An argument may hold file names anywhere: "mask:FILE", "error:FILE", "--mask=FILE".
void WorkFolder::check_argument(const std::string& argument) const {
  if (argument.find('\0') != std::string::npos) refuse_outside(argument);
  std::string piece;
  const auto check_piece = [&] {
    if (piece.starts_with('/') || piece.starts_with('~') || piece.find('\\') != std::string::npos)
      refuse_outside(argument);
    for (const fs::path& part : fs::path(piece))
      if (part == "..") refuse_outside(argument);
    // Links of the user's folder may lead out of it; those in the temporary folder were opened by the user.
    std::error_code error;
    if (!piece.empty() && !is_temporary_ && !is_within(fs::weakly_canonical(path_ / piece, error), path_))
      refuse_outside(argument);
    piece.clear();
  };
  for (const char c : argument) {
    if (c == ':' || c == '=' || c == ',')
      check_piece();
    else
      piece += c;
  }
  check_piece();
  // "-o../mesh.ply": a short flag and its value in one.
  if (argument.size() > 2 && argument[0] == '-' && argument[1] != '-') check_argument(argument.substr(2));
}

void WorkFolder::check(const std::vector<std::string>& arguments) const {
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    check_argument(arguments[i]);
    for (const std::string_view flag : outputs) {
      std::string file;
      if (arguments[i] == flag && i + 1 < arguments.size()) file = arguments[i + 1];
      if (arguments[i].starts_with(std::string(flag) + "=")) file = arguments[i].substr(flag.size() + 1);
      if (flag == "-o" && arguments[i].size() > 2 && arguments[i].starts_with(flag)) file = arguments[i].substr(2);
      std::error_code error;
      if (!file.empty() && !is_made(file) && fs::exists(fs::symlink_status(path_ / file, error)))
        throw Refused(409, "\"" + file + "\" was there before and is not replaced; take another name");
    }
  }
}

WorkFolder::Snapshot WorkFolder::snapshot(bool preview) const {
  Snapshot all;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(preview ? preview_ : path_, error)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with('.')) continue;
    if (entry.is_regular_file(error)) all[name] = {entry.last_write_time(error), entry.file_size(error)};
    if (preview || !entry.is_directory(error) || entry.is_symlink(error)) continue;
    for (const fs::directory_entry& file : fs::directory_iterator(entry.path(), error))  // of track
      if (!file.path().filename().string().starts_with('.') && file.is_regular_file(error))
        all[name + "/" + file.path().filename().string()] = {file.last_write_time(error), file.file_size(error)};
  }
  return all;
}

std::vector<std::string> WorkFolder::written_since(const Snapshot& before, bool preview) {
  std::vector<std::pair<fs::file_time_type, std::string>> written;
  for (const auto& [name, state] : snapshot(preview)) {
    const auto found = before.find(name);
    if (found == before.end() || found->second != state) written.emplace_back(state.first, name);
  }
  std::sort(written.begin(), written.end());
  std::vector<std::string> result;
  for (const auto& [time, name] : written) {
    result.push_back(preview ? std::string(preview_prefix) + name : name);
    if (preview) continue;
    keep(name);
    made_.insert(name);
  }
  return result;
}

std::vector<std::string> WorkFolder::names() const {
  return names_;
}

void WorkFolder::forget(const std::string& name) {
  std::erase(names_, name);
  made_.erase(name);
}

void WorkFolder::remove(const std::string& name) {
  const fs::path path = find(name);
  std::error_code error;
  if (is_made(name)) fs::remove(path, error);
  forget(name);
}

}  // namespace csrbf::app
