#include "csrbf/io/files/gzip_file.hpp"

#include "csrbf/io/files/atomic_file.hpp"
#include "csrbf/io/files/deflate.hpp"
#include "csrbf/io/files/read_file.hpp"

#include <filesystem>

namespace csrbf {

std::string content_extension(const std::string& path) {
  const std::string extension = file_extension(path);
  return extension == ".gz" ? file_extension(std::filesystem::path(path).stem().string()) : extension;
}

std::string read_content(const std::string& path) {
  std::string bytes = read_file(path);
  return bytes.starts_with("\x1F\x8B") ? inflate_all(bytes, display_name(path)) : bytes;
}

void write_content(const std::string& path, std::string_view bytes) {
  if (file_extension(path) == ".gz")
    write_file(path, deflate_bytes({bytes}, DeflateFormat::gzip));
  else
    write_file(path, bytes);
}

}  // namespace csrbf
