#include "csrbf/io/files/gzip_file.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/atomic_file.hpp"
#include "csrbf/io/files/deflate.hpp"
#include "csrbf/io/files/guessed_format.hpp"
#include "csrbf/io/files/read_file.hpp"

#include <filesystem>

namespace csrbf {

std::string content_extension(const std::string& path) {
  const std::string extension = file_extension(path);
  return extension == ".gz" ? file_extension(std::filesystem::path(path).stem().string()) : extension;
}

Content read_with_format(const std::string& path, const std::string& known, const std::string& text,
                         const std::string& kinds) {
  const auto check = [&](const std::string& extension) {
    if (!is_listed(extension, known)) refuse_extension(display_name(path), extension, kinds + " are " + known);
  };
  Content content{content_extension(path), {}};
  if (!content.extension.empty()) check(content.extension);
  content.bytes = read_content(path);
  if (content.extension.empty()) {
    content.extension = guessed_format(content.bytes);
    if (content.extension.empty()) content.extension = text;
    if (!is_listed(content.extension, known))
      throw IoError(display_name(path) + ": its content looks like that of " + content.extension + " files; " + kinds +
                    " are " + known);
  }
  return content;
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
