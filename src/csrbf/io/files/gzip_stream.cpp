#include "csrbf/io/files/gzip_stream.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/interruption.hpp"

#include <zlib.h>

#include <algorithm>

namespace csrbf {
namespace {

constexpr std::size_t piece_bytes = std::size_t{1} << 18;        // of a file that are read or written at once
constexpr std::uint64_t bytes_between = std::uint64_t{1} << 24;  // of the content, between states that are kept
constexpr int any_member = 15 + 32, gzip_member = 15 + 16;       // the largest window, with the header of gzip

}  // namespace

struct GzipReader::State {
  z_stream stream{};
  std::int64_t consumed = 0;   // bytes of the file
  std::uint64_t position = 0;  // in the content
  bool at_end = false;

  State() = default;
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() { inflateEnd(&stream); }

  [[nodiscard]] std::unique_ptr<State> copy() {
    auto result = std::make_unique<State>();
    if (inflateCopy(&result->stream, &stream) != Z_OK) throw SolverFailure("zlib: no memory is left");
    result->stream.avail_in = 0;
    result->consumed = consumed;
    result->position = position;
    result->at_end = at_end;
    return result;
  }
};

GzipReader::GzipReader(OpenFile file, std::string name)
    : file_(std::move(file)), name_(std::move(name)), state_(std::make_unique<State>()), input_(piece_bytes) {
  if (inflateInit2(&state_->stream, any_member) != Z_OK) throw IoError(name_ + ": zlib cannot start");
  kept_.push_back(state_->copy());
}

GzipReader::GzipReader(GzipReader&&) noexcept = default;
GzipReader::~GzipReader() = default;

std::size_t GzipReader::read(std::uint64_t position, std::span<char> to) {
  go_to(position);
  std::size_t count = 0;
  while (count < to.size() && !state_->at_end) count += inflate_some(to.subspan(count));
  return count;
}

// From the last state before it, unless the present one is nearer.
void GzipReader::go_to(std::uint64_t position) {
  const auto after = std::upper_bound(kept_.begin(), kept_.end(), position,
                                      [](std::uint64_t p, const auto& state) { return p < state->position; });
  State& last = **(after - 1);
  if (state_->position > position || last.position > state_->position) {
    state_ = last.copy();
    if (!seek_file(file_.get(), state_->consumed, SEEK_SET)) throw IoError(name_ + ": cannot be read");
  }
  std::vector<char> passed(piece_bytes);
  while (state_->position < position && !state_->at_end)
    inflate_some(std::span(passed).first(std::min<std::uint64_t>(piece_bytes, position - state_->position)));
}

// What one call of zlib makes of the content.
std::size_t GzipReader::inflate_some(std::span<char> to) {
  stop_if_interrupted();
  z_stream& stream = state_->stream;
  if (stream.avail_in == 0) {
    stream.next_in = reinterpret_cast<Bytef*>(input_.data());
    stream.avail_in = static_cast<uInt>(std::fread(input_.data(), 1, input_.size(), file_.get()));
    if (stream.avail_in == 0)
      throw IoError(name_ + ": the file is truncated: the end of its compressed data is missing");
  }
  const uInt given = stream.avail_in;
  const std::size_t room = std::min(to.size(), piece_bytes);
  stream.next_out = reinterpret_cast<Bytef*>(to.data());
  stream.avail_out = static_cast<uInt>(room);
  const int status = inflate(&stream, Z_NO_FLUSH);
  const std::size_t made = room - stream.avail_out;
  state_->consumed += given - stream.avail_in;
  state_->position += made;
  if (status == Z_STREAM_END) {
    const bool more = stream.avail_in > 0 || std::ungetc(std::fgetc(file_.get()), file_.get()) != EOF;
    state_->at_end = !more;
    if (more) inflateReset(&stream);  // another member of the file follows
  } else if (status != Z_OK && status != Z_BUF_ERROR) {
    throw IoError(
        name_ + ": the compressed data are damaged: " + (stream.msg != nullptr ? stream.msg : "zlib gives no reason"));
  }
  if (state_->position >= kept_.back()->position + bytes_between) kept_.push_back(state_->copy());
  return made;
}

struct GzipWriter::State {
  z_stream stream{};
  std::string output = std::string(piece_bytes, '\0');

  State() = default;
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() { deflateEnd(&stream); }
};

GzipWriter::GzipWriter(AtomicFile& file) : file_(file), state_(std::make_unique<State>()) {
  constexpr int level = 3, memory_level = 8;  // as deflate_bytes()
  if (deflateInit2(&state_->stream, level, Z_DEFLATED, gzip_member, memory_level, Z_DEFAULT_STRATEGY) != Z_OK)
    throw IoError("zlib cannot start");
}

GzipWriter::GzipWriter(GzipWriter&&) noexcept = default;
GzipWriter::~GzipWriter() = default;

void GzipWriter::write(std::string_view bytes) {
  z_stream& stream = state_->stream;
  while (!bytes.empty()) {
    stop_if_interrupted();
    const std::size_t some = std::min(bytes.size(), piece_bytes);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream.avail_in = static_cast<uInt>(some);
    deflate_to_file(Z_NO_FLUSH);
    bytes.remove_prefix(some);
  }
}

void GzipWriter::finish() {
  deflate_to_file(Z_FINISH);
}

void GzipWriter::deflate_to_file(int flush) {
  z_stream& stream = state_->stream;
  do {
    stream.next_out = reinterpret_cast<Bytef*>(state_->output.data());
    stream.avail_out = static_cast<uInt>(state_->output.size());
    deflate(&stream, flush);
    file_.write(std::string_view(state_->output).substr(0, state_->output.size() - stream.avail_out));
  } while (stream.avail_out == 0);
}

}  // namespace csrbf
