#include "csrbf/io/files/file_part.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/interruption.hpp"

#include <cerrno>
#include <system_error>

#ifndef _WIN32
#include <fcntl.h>
#include <unistd.h>
#endif

namespace csrbf {
namespace {

// Only for writing: clients of network file systems that read a page as well write all of it, with old bytes where
// another machine has written.
std::FILE* open_to_write(const std::string& path) {
#ifdef _WIN32
  return open_file(path, "r+b");
#else
  const int descriptor = open(path.c_str(), O_WRONLY | O_CLOEXEC);
  return descriptor < 0 ? nullptr : fdopen(descriptor, "wb");
#endif
}

}  // namespace

FilePart::FilePart(const std::string& path, std::int64_t begin) : path_(path), file_(open_to_write(path)) {
  if (file_ == nullptr || !seek_file(file_.get(), begin, SEEK_SET)) fail();
}

void FilePart::write(std::string_view bytes) {
  stop_if_interrupted();
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_.get()) != bytes.size()) fail();
}

void FilePart::close() {
  std::FILE* const file = file_.release();
  const bool flushed = std::fflush(file) == 0;
  const int error = errno;
  const bool closed = std::fclose(file) == 0;
  if (!flushed) errno = error;
  if (!flushed || !closed) fail();
}

void FilePart::fail() const {
  throw IoError(path_ + ": cannot write the file: " + std::generic_category().message(errno));
}

}  // namespace csrbf
