#include "csrbf/io/files/atomic_file.hpp"

#include "csrbf/core/interruption.hpp"
#include "csrbf/io/files/open_file.hpp"
#include "csrbf/io/files/process_files.hpp"

#include <atomic>
#include <cerrno>
#include <filesystem>
#include <system_error>

#ifdef _WIN32
#include <io.h>
#include <process.h>
#else
#include <fcntl.h>
#include <unistd.h>
#endif

namespace csrbf {
namespace {

namespace fs = std::filesystem;

bool discarding = false;

#ifdef _WIN32
constexpr const char* nowhere = "NUL";

int process_number() {
  return _getpid();
}

bool is_writable(const std::string& path) {
  constexpr int to_write = 2;
  return _waccess(utf8_path(path).c_str(), to_write) == 0;
}
#else
constexpr const char* nowhere = "/dev/null";

int process_number() {
  return getpid();
}

bool is_writable(const std::string& path) {
  return access(path.c_str(), W_OK) == 0;
}
#endif

std::string reason(int error) {
  return std::generic_category().message(error);
}

// A hidden name beside the target, unique among the processes and threads that are writing there. A killed one may
// have left a file of this name.
std::string temporary_name(const fs::path& target) {
  static std::atomic<unsigned> counter{0};
  const std::string unique = std::to_string(process_number()) + "-" + std::to_string(counter++);
  return utf8_name(target.parent_path() / utf8_path("." + utf8_name(target.filename()) + "." + unique + ".tmp"));
}

// Replacing a file needs no write permission for it, but whoever removed that permission wants to keep the file.
bool is_protected(const std::string& path) {
  return !is_writable(path);
}

}  // namespace

void discard_files() {
  discarding = true;
}

AtomicFile::AtomicFile(const std::string& path) : path_(path), target_(discarding ? nowhere : path) {
  std::error_code error;
  const fs::file_status status = fs::status(utf8_path(target_), error);
  if (status.type() == fs::file_type::directory) {
    errno = EISDIR;
    fail("write");
  }
  const bool in_place = fs::exists(status) && status.type() != fs::file_type::regular;
  if (!in_place) {
    if (fs::exists(status)) target_ = utf8_name(fs::canonical(utf8_path(path), error));
    if (target_.empty()) target_ = path;
    if (fs::exists(status) && is_protected(target_)) fail("write");
  }
  do {
    if (!in_place) temporary_ = temporary_name(utf8_path(target_));
    file_ = open_file(in_place ? target_ : temporary_, in_place ? "wb" : "wbx");
  } while (file_ == nullptr && !in_place && errno == EEXIST);
  if (file_ == nullptr) {
    temporary_.clear();
    fail("write");
  }
}

AtomicFile::~AtomicFile() {
  if (file_ != nullptr) std::fclose(file_);
  std::error_code error;
  if (!temporary_.empty()) fs::remove(utf8_path(temporary_), error);
}

void AtomicFile::reserve(std::uint64_t bytes) {
#ifdef __linux__
  const auto length = static_cast<off_t>(bytes);
  if (!temporary_.empty() && fallocate(fileno(file_), FALLOC_FL_KEEP_SIZE, 0, length) != 0 && errno == ENOSPC)
    fail("write");
#else
  static_cast<void>(bytes);
#endif
}

void AtomicFile::write(std::string_view bytes) {
  constexpr std::size_t largest_write = std::size_t{1} << 24;
  while (!bytes.empty()) {
    stop_if_interrupted();
    const std::string_view part = bytes.substr(0, largest_write);
    if (std::fwrite(part.data(), 1, part.size(), file_) != part.size()) fail("write");
    bytes.remove_prefix(part.size());
  }
}

void AtomicFile::take(const std::string& complete) {
  if (!temporary_.empty()) {
    std::fclose(file_);
    std::error_code error;
    fs::remove(utf8_path(temporary_), error);
    fs::create_hard_link(utf8_path(complete), utf8_path(temporary_), error);
    file_ = open_file(temporary_, error ? "wbx" : "r+b");
    if (file_ == nullptr) fail("write");
    if (!error) return;
  }
  const OpenFile source(open_file(complete, "rb"));
  if (source == nullptr) throw IoError(complete + ": cannot be read: " + reason(errno));
  std::string bytes(std::size_t{1} << 22, '\0');
  while (const std::size_t read = std::fread(bytes.data(), 1, bytes.size(), source.get()))
    write(std::string_view(bytes).substr(0, read));
  if (std::ferror(source.get()) != 0) throw IoError(complete + ": cannot be read: " + reason(errno));
}

void AtomicFile::commit() {
  std::FILE* file = file_;
  file_ = nullptr;
  const bool flushed = std::fflush(file) == 0;
  const int flush_error = errno;
  const bool closed = std::fclose(file) == 0;
  if (!flushed) errno = flush_error;
  if (!flushed || !closed) fail("write");
  if (temporary_.empty()) return;
  std::error_code error;
  fs::rename(utf8_path(temporary_), utf8_path(target_), error);
  if (error) {
    errno = error.value();
    fail("replace");
  }
  temporary_.clear();
}

void AtomicFile::fail(const char* action) const {
  const int error = errno;
  throw OutputError(path_ + ": cannot " + action + " the file: " + reason(error));
}

void write_file(const std::string& path, std::string_view bytes) {
  if (path != "-") {
    AtomicFile file(path);
    file.write(bytes);
    file.commit();
  } else if (std::fwrite(bytes.data(), 1, bytes.size(), stdout) != bytes.size() || std::fflush(stdout) != 0) {
    throw OutputError("standard output: cannot write: " + reason(errno));
  }
}

}  // namespace csrbf
