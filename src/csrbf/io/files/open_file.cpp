#include "csrbf/io/files/open_file.hpp"

namespace csrbf {

#ifdef _WIN32
std::filesystem::path utf8_path(const std::string& name) {
  return std::u8string(name.begin(), name.end());
}

std::string utf8_name(const std::filesystem::path& path) {
  const std::u8string name = path.u8string();
  return {name.begin(), name.end()};
}

std::FILE* open_file(const std::string& path, const char* mode) {
  return _wfopen(utf8_path(path).c_str(), utf8_path(mode).c_str());
}

bool seek_file(std::FILE* file, std::int64_t offset, int origin) {
  return _fseeki64(file, offset, origin) == 0;
}
#else
std::filesystem::path utf8_path(const std::string& name) {
  return name;
}

std::string utf8_name(const std::filesystem::path& path) {
  return path.string();
}

std::FILE* open_file(const std::string& path, const char* mode) {
  return std::fopen(path.c_str(), mode);
}

bool seek_file(std::FILE* file, std::int64_t offset, int origin) {
  return fseeko(file, static_cast<off_t>(offset), origin) == 0;
}
#endif

}  // namespace csrbf
