#include "csrbf/io/files/read_file.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/inside_parallel_loop.hpp"
#include "csrbf/core/interruption.hpp"
#include "csrbf/io/files/open_file.hpp"
#include "csrbf/io/files/process_files.hpp"
#include "csrbf/io/files/text.hpp"

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <system_error>

namespace csrbf {
namespace {

[[noreturn]] void fail(const std::string& path, int error) {
  throw IoError(display_name(path) + ": cannot read the file: " + std::generic_category().message(error));
}

struct Close {
  void operator()(std::FILE* file) const {
    if (file != stdin) std::fclose(file);
  }
};

std::function<std::string(const std::string&)> reader_in_use;

// By path.
std::map<std::string, std::string>& assumed_formats() {
  static std::map<std::string, std::string> formats;
  return formats;
}

}  // namespace

void set_file_reader(std::function<std::string(const std::string&)> reader) {
  reader_in_use = std::move(reader);
}

std::string read_file(const std::string& path) {
  return reader_in_use && !inside_parallel_loop() ? reader_in_use(path) : read_file_here(path);
}

std::string read_file_here(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (path != "-" && fs::is_directory(utf8_path(path), error)) fail(path, EISDIR);
  const std::unique_ptr<std::FILE, Close> file(path == "-" ? stdin : open_file(path, "rb"));
  if (!file) fail(path, errno);

  // A single read when the size is known, in parts between which it may be interrupted; for pipes the buffer grows.
  constexpr std::size_t first_guess = std::size_t{1} << 16, largest_read = std::size_t{1} << 24;  // bytes
  std::size_t capacity = first_guess;
  if (path != "-" && fs::is_regular_file(utf8_path(path), error))
    capacity = static_cast<std::size_t>(fs::file_size(utf8_path(path))) + 1;
  std::string content;
  std::size_t size = 0;
  while (true) {
    stop_if_interrupted();
    content.resize(capacity);
    const std::size_t wanted = std::min(largest_read, capacity - size);
    const std::size_t found = std::fread(content.data() + size, 1, wanted, file.get());
    size += found;
    if (std::ferror(file.get()) != 0) fail(path, errno);
    if (found < wanted) break;
    if (size == capacity) capacity *= 2;
  }
  content.resize(size);
  return content;
}

std::string display_name(const std::string& path) {
  return path == "-" ? "standard input" : path;
}

void assume_format(const std::string& path, const std::string& extension) {
  assumed_formats()[path] = extension;
}

std::string file_extension(const std::string& path) {
  const auto assumed = assumed_formats().find(path);
  if (assumed != assumed_formats().end()) return assumed->second;
  return path == "-" ? "" : lower_case(std::filesystem::path(path).extension().string());
}

bool is_listed(std::string_view extension, std::string_view list) {
  while (true) {
    const std::string_view listed = take_word(list);
    if (listed.empty() || listed == extension) return !listed.empty();
  }
}

void refuse_extension(const std::string& path, const std::string& extension, const std::string& what) {
  throw IoError(path + ": unknown extension " + in_quotes(extension) + "; " + what);
}

}  // namespace csrbf
