#include "process/resume_log.hpp"

#include "common.hpp"
#include "process/interrupt.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/parallel.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <sstream>
#include <system_error>
#include <thread>
#include <utility>

namespace csrbf::app {
namespace {

constexpr std::string_view magic = "csrbf resume 1\n";
constexpr double record_seconds = 0.5;  // of work in a record, which a kill can cost; up to twice as much
constexpr std::size_t record_bytes = std::size_t{32} << 20;  // of a record, about: bounds the memory for it
constexpr double reading_rate = 200e6;  // bytes per second of a slow disk: results computed faster are not saved
constexpr std::size_t longest_key = std::size_t{1} << 20;  // a longer one is not of a log

using Bytes = std::span<const std::byte>;

Bytes bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

// Multiplicative hashing of 8 bytes at a time.
std::uint64_t hash(Bytes bytes, std::uint64_t h) {
  constexpr std::uint64_t odd = 0x9e3779b97f4a7c15;  // 2^64 / golden ratio
  for (std::size_t i = 0; i < bytes.size(); i += sizeof(h)) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes.data() + i, std::min(sizeof(word), bytes.size() - i));
    h = (h ^ word) * odd;
    h ^= h >> 32;
  }
  return (h ^ bytes.size()) * odd;
}

[[noreturn]] void fail(const std::string& path, int error) {
  throw IoError(path + ": cannot use the file: " + std::generic_category().message(error));
}

// A run that was just killed may hold the lock for another moment.
bool lock(int file) {
  constexpr int attempts = 30;  // 3 s
  for (int i = 0; i < attempts; ++i) {
    if (flock(file, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return true;
    if (interrupted()) throw Cancelled();
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  return false;
}

bool read_all(int file, void* to, std::size_t size, off_t at) {
  auto* next = static_cast<std::byte*>(to);
  while (size > 0) {
    const ssize_t got = pread(file, next, size, at);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    next += got;
    at += got;
    size -= static_cast<std::size_t>(got);
  }
  return true;
}

bool write_all(int file, Bytes bytes, off_t at) {
  while (!bytes.empty()) {
    const ssize_t put = pwrite(file, bytes.data(), bytes.size(), at);
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) return false;
    at += put;
    bytes = bytes.subspan(static_cast<std::size_t>(put));
  }
  return true;
}

std::uint64_t kind_of(const SharedWork& work) {
  return hash(bytes_of(work.name),
              static_cast<std::uint64_t>(work.items) * 31 + static_cast<std::uint64_t>(work.grain));
}

// The first line of `theirs` that is not in `ours`, and what is there instead.
std::string difference(const std::string& theirs, const std::string& ours) {
  std::istringstream a(theirs), b(ours);
  for (std::string x, y;;) {
    const bool has_x = static_cast<bool>(std::getline(a, x)), has_y = static_cast<bool>(std::getline(b, y));
    if (!has_x) x = "nothing more";
    if (!has_y) y = "nothing more";
    if (x != y || (!has_x && !has_y)) return "it says \"" + x + "\", this run \"" + y + "\"";
  }
}

}  // namespace

std::uint64_t fingerprint(const std::string& path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) throw IoError(path + ": cannot read the file: " + std::generic_category().message(errno));
  std::vector<std::byte> part(std::size_t{1} << 20);
  std::uint64_t h = 0;
  ssize_t got = 1;
  for (off_t at = 0; got > 0; at += got) {
    got = pread(file, part.data(), part.size(), at);
    if (got > 0) h = hash(Bytes(part).first(static_cast<std::size_t>(got)), h);
  }
  const int error = errno;
  close(file);
  if (got < 0) throw IoError(path + ": cannot read the file: " + std::generic_category().message(error));
  return h;
}

ResumeLog::ResumeLog(const std::string& path, const std::string& key)
    : path_(path), file_(open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666)) {
  if (file_ < 0) fail(path, errno);
  try {
    if (!lock(file_)) throw UsageError(path + ": in use by another run; wait until it ends");
    read_header(key);
    record_ = read_record();
  } catch (...) {
    close(file_);
    throw;
  }
  set_work_sharing(this);
}

ResumeLog::~ResumeLog() {
  set_work_sharing(nullptr);
  close(file_);
}

void ResumeLog::remove() const {
  unlink(path_.c_str());
}

// The size is written last: a size of zero means that the run was killed while it created the log.
void ResumeLog::read_header(const std::string& key) {
  std::string header = std::string(magic) + key;
  const std::uint64_t size = header.size(), sum = hash(bytes_of(header), size);
  std::array<std::uint64_t, 2> there{};
  std::string found;
  if (read_all(file_, there.data(), sizeof(there), 0) && there[0] <= longest_key) {
    found.resize(there[0]);
    if (!read_all(file_, found.data(), found.size(), sizeof(there))) found.clear();
  }
  end_ = static_cast<off_t>(sizeof(there) + header.size());
  if (found == header && there[1] == sum) return;
  if (!found.empty() && there[1] == hash(bytes_of(found), found.size()))
    throw UsageError(path_ + ": belongs to another input, version or set of options (" + difference(found, header) +
                     "); finish that run, or delete the file to start over");
  struct stat about {};
  if (fstat(file_, &about) != 0 || (about.st_size > 0 && there[0] != 0))
    throw UsageError(path_ + ": is not a resume log; delete or rename it to start over");
  const std::array<std::uint64_t, 2> front = {size, sum};
  if (ftruncate(file_, 0) != 0 || !write_all(file_, bytes_of(header), sizeof(front)) ||
      !write_all(file_, std::as_bytes(std::span(front)), 0))
    fail(path_, errno);
}

// The next record. Where there is no valid one, the log is cut off.
std::optional<ResumeLog::Record> ResumeLog::read_record() {
  Record record{};
  struct stat about {};
  Head& head = record.head;
  if (fstat(file_, &about) == 0 && read_all(file_, &head, sizeof(head), end_) &&
      head.size <= static_cast<std::uint64_t>(about.st_size - end_)) {
    record.results.resize(head.size);
    const std::uint64_t sum = std::exchange(head.checksum, 0);
    if (read_all(file_, record.results.data(), record.results.size(), end_ + static_cast<off_t>(sizeof(head))) &&
        sum == hash(record.results, hash(std::as_bytes(std::span(&head, 1)), 0))) {
      end_ += static_cast<off_t>(sizeof(head) + head.size);
      return record;
    }
  }
  if (ftruncate(file_, end_) != 0) use_.error = errno;
  return std::nullopt;
}

void ResumeLog::share(const SharedWork& work) {
  ++works_;
  const std::uint64_t kind = kind_of(work);
  Index done = 0;
  while (record_ && record_->head.work == works_) {
    const Head& head = record_->head;
    if (head.kind != kind || head.first < done || head.last > work.blocks())
      throw UsageError(path_ + ": was written by another build of the program; delete the file to start over");
    work.compute_blocks(done, head.first);
    take_over(work, *record_);
    done = head.last;
    record_ = read_record();
  }
  if (record_)
    work.compute_blocks(done, work.blocks());
  else
    compute_and_keep(work, kind, done);
}

void ResumeLog::take_over(const SharedWork& work, const Record& record) {
  ByteReader in(record.results);
  for (Index block = record.head.first; block < record.head.last; ++block)
    work.unpack(work.begin(block), work.end(block), in);
  use_.taken_bytes += record.results.size();
  use_.seconds_saved += record.head.seconds;
}

// Batches of blocks, as many as take about `record_seconds`.
void ResumeLog::compute_and_keep(const SharedWork& work, std::uint64_t kind, Index first) {
  using Clock = std::chrono::steady_clock;
  Index batch = 4 * thread_count();
  ByteWriter out;
  while (first < work.blocks()) {
    if (interrupted()) throw Cancelled();
    const Index last = std::min(work.blocks(), first + batch);
    const auto start = Clock::now();
    work.compute_blocks(first, last);
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    out.clear();
    for (Index block = first; block < last; ++block) work.pack(work.begin(block), work.end(block), out);
    const std::size_t size = out.bytes().size();
    if (static_cast<double>(size) < reading_rate * seconds)
      append({works_, kind, first, last, seconds, size, 0}, out.bytes());
    first = last;
    if (seconds < record_seconds / 2 && size < record_bytes / 2) batch *= 2;
    if (seconds > record_seconds || size > record_bytes) batch = std::max<Index>(1, batch / 2);
  }
}

// The run goes on when the log cannot grow.
void ResumeLog::append(Head head, Bytes results) {
  if (use_.error != 0) return;
  head.checksum = hash(results, hash(std::as_bytes(std::span(&head, 1)), 0));
  const auto results_at = end_ + static_cast<off_t>(sizeof(head));
  if (!write_all(file_, results, results_at) || !write_all(file_, std::as_bytes(std::span(&head, 1)), end_)) {
    use_.error = errno;
    if (ftruncate(file_, end_) != 0) use_.error = errno;
    return;
  }
  end_ = results_at + static_cast<off_t>(results.size());
  use_.written_bytes += sizeof(head) + results.size();
}

}  // namespace csrbf::app
