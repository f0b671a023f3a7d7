#include "csrbf/tiles/folder/tile_folder.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/open_file.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <thread>

namespace csrbf {
namespace {

constexpr const char* suffix = ".tiles";  // of every file in the folder; incomplete ones have more behind it

}  // namespace

bool exists(const std::string& path) {
  std::error_code ignored;
  return std::filesystem::exists(utf8_path(path), ignored);
}

TileFolder::TileFolder(std::string path) : path_(std::move(path)) {
  std::error_code error;
  std::filesystem::create_directories(utf8_path(path_), error);
  if (error) throw IoError(path_ + ": cannot be made: " + error.message());
}

std::string TileFolder::file(const std::string& kind) const {
  return utf8_name(utf8_path(path_) / utf8_path(kind + suffix));
}

std::string TileFolder::file(const std::string& kind, Index tile) const {
  return file(kind + "_" + std::to_string(tile));
}

std::vector<std::string> TileFolder::files(const std::string& kind) const {
  std::error_code ignored;
  std::vector<std::string> found;
  for (const auto& entry : std::filesystem::directory_iterator(utf8_path(path_), ignored))
    if (utf8_name(entry.path().filename()).starts_with(kind)) found.push_back(utf8_name(entry.path()));
  return found;
}

void TileFolder::clear(const std::vector<std::string>& kept) const {
  std::error_code ignored;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(utf8_path(path_), ignored)) {
    const std::string name = utf8_name(entry.path().filename());
    const std::size_t start = name[0] == '.' ? 1 : 0;  // of the kind, also in incomplete files
    const auto begins = [&](const std::string& kind) { return name.compare(start, kind.size(), kind) == 0; };
    if (name.find(suffix) != std::string::npos && std::none_of(kept.begin(), kept.end(), begins))
      files.push_back(entry.path());
  }
  for (const std::filesystem::path& path : files) std::filesystem::remove(path, ignored);
}

void TileFolder::remove(const std::string& first) const {
  std::error_code ignored;
  std::filesystem::remove(utf8_path(file(first)), ignored);
  clear({});
  std::filesystem::remove(utf8_path(path_), ignored);  // fails where other files are left
}

void wait_until(const std::function<bool()>& done, const std::function<void()>& check) {
  auto pause = std::chrono::milliseconds(5);
  constexpr auto longest = std::chrono::milliseconds(500);
  while (!done()) {
    check();
    std::this_thread::sleep_for(pause);
    pause = std::min(2 * pause, longest);
  }
}

}  // namespace csrbf
