#pragma once

#include <cstdio>
#include <filesystem>
#include <string>

namespace csrbf {

/// The path of a name in UTF-8, and back: on Windows std::filesystem takes other names for those of its code page.
std::filesystem::path utf8_path(const std::string& name);
std::string utf8_name(const std::filesystem::path& path);

/// fopen() of a name in UTF-8.
std::FILE* open_file(const std::string& path, const char* mode);

}  // namespace csrbf
