#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

namespace csrbf {

/// The path of a name in UTF-8, and back: on Windows std::filesystem takes other names for those of its code page.
std::filesystem::path utf8_path(const std::string& name);
std::string utf8_name(const std::filesystem::path& path);

/// fopen() of a name in UTF-8.
std::FILE* open_file(const std::string& path, const char* mode);

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

/// A file that is closed at the end, whatever was written: see AtomicFile for outputs.
using OpenFile = std::unique_ptr<std::FILE, CloseFile>;

/// fseek() in files of any size. Returns whether it worked.
bool seek_file(std::FILE* file, std::int64_t offset, int origin);

}  // namespace csrbf
