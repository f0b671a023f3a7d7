#include "csrbf/io/files/deflate.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/interruption.hpp"

#include <zlib.h>

#include <algorithm>
#include <limits>
#include <memory>

namespace csrbf {
namespace {

constexpr std::size_t largest_chunk = std::size_t{1} << 22;  // between chunks the work may be interrupted
constexpr int window = 15;                                   // zlib's default, and the largest
constexpr int detect_format = 32;
constexpr int write_gzip = 16;

// zlib takes its input through non-const pointers but never writes to it.
void give_input(z_stream& stream, std::string_view& bytes) {
  if (stream.avail_in > 0 || bytes.empty()) return;
  const std::size_t chunk = std::min(bytes.size(), largest_chunk);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(chunk);
  bytes.remove_prefix(chunk);
}

void give_output(z_stream& stream, std::string& out, std::size_t used) {
  stream.next_out = reinterpret_cast<Bytef*>(out.data() + used);
  stream.avail_out = static_cast<uInt>(std::min(out.size() - used, largest_chunk));
}

class Inflater {
 public:
  explicit Inflater(const std::string& name) : name_(name) {
    if (inflateInit2(&stream_, window + detect_format) != Z_OK) throw IoError(name_ + ": zlib cannot start");
  }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;
  ~Inflater() { inflateEnd(&stream_); }

  struct Result {
    std::size_t size = 0;
    bool cut = false;  // the end of the stream is missing
  };

  // Fills `out` as far as the stream goes; it grows if it may. The trailer of a stream, with its checksum, is read even
  // when `out` is full.
  Result run(std::string_view compressed, std::string& out, bool grows = false) {
    std::size_t used = 0;
    while (true) {
      stop_if_interrupted();
      if (grows && used == out.size()) out.resize(2 * out.size());
      give_input(stream_, compressed);
      give_output(stream_, out, used);
      const uInt room = stream_.avail_out;
      const int status = inflate(&stream_, Z_NO_FLUSH);
      used += room - stream_.avail_out;
      if (status == Z_STREAM_END) {
        if ((used == out.size() && !grows) || (stream_.avail_in == 0 && compressed.empty())) return {used, false};
        inflateReset(&stream_);  // another member of the file follows
      } else if (status == Z_BUF_ERROR) {
        return {used, stream_.avail_in == 0 && compressed.empty()};  // nothing left to read, or more than fits
      } else if (status != Z_OK) {
        throw IoError(name_ + ": the compressed data are damaged: " +
                      (stream_.msg != nullptr ? stream_.msg : "zlib gives no reason"));
      }
    }
  }

 private:
  const std::string& name_;
  z_stream stream_{};
};

}  // namespace

std::string inflate_all(std::string_view compressed, const std::string& name) {
  constexpr std::size_t usual_ratio = 4, least = 4096;  // a first guess of the size, which grows
  std::string out(std::max(least, usual_ratio * compressed.size()), '\0');
  const Inflater::Result result = Inflater(name).run(compressed, out, true);
  if (result.cut) throw IoError(name + ": the file is truncated: the end of its compressed data is missing");
  out.resize(result.size);
  return out;
}

std::string inflate_head(std::string_view compressed, std::size_t size, const std::string& name) {
  std::string out(size, '\0');
  Inflater inflater(name);
  out.resize(inflater.run(compressed, out).size);
  return out;
}

std::string inflate_bytes(std::string_view compressed, std::size_t size, const std::string& name) {
  std::string out(size, '\0');
  const Inflater::Result result = Inflater(name).run(compressed, out);
  if (result.size < size)
    throw IoError(name + ": the file is truncated: its compressed data hold " + std::to_string(result.size) + " of " +
                  std::to_string(size) + " bytes");
  if (result.cut) throw IoError(name + ": the file is truncated: the checksum of its compressed data is missing");
  return out;
}

std::string deflate_bytes(std::initializer_list<std::string_view> parts, DeflateFormat format) {
  constexpr int level = 3;         // see deflate.hpp
  constexpr int memory_level = 8;  // zlib's default
  z_stream stream{};
  if (deflateInit2(&stream, level, Z_DEFLATED, format == DeflateFormat::gzip ? window + write_gzip : window,
                   memory_level, Z_DEFAULT_STRATEGY) != Z_OK)
    throw IoError("zlib cannot start");
  const std::unique_ptr<z_stream, int (*)(z_stream*)> end(&stream, deflateEnd);
  constexpr std::size_t first_guess = std::size_t{1} << 20;  // bytes of the result; grows
  std::string out(first_guess, '\0');
  std::size_t used = 0;
  const auto run = [&](int flush) {
    if (used == out.size()) out.resize(2 * out.size());
    give_output(stream, out, used);
    const uInt room = stream.avail_out;
    const int status = deflate(&stream, flush);
    used += room - stream.avail_out;
    return status;
  };
  for (std::string_view part : parts)
    while (stream.avail_in > 0 || !part.empty()) {
      stop_if_interrupted();
      give_input(stream, part);
      run(Z_NO_FLUSH);
    }
  while (run(Z_FINISH) != Z_STREAM_END) continue;
  out.resize(used);
  return out;
}

}  // namespace csrbf
