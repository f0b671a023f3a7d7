#pragma once

#include "csrbf/io/files/atomic_file.hpp"
#include "csrbf/io/files/open_file.hpp"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace csrbf {

/// Reads the content of a gzip file at any place, a part at a time. On the way it keeps states of the decompressor, 40
/// kB each, from which it goes on when it has to go back.
class GzipReader {
 public:
  /// `file` at its beginning; `name` is for messages.
  GzipReader(OpenFile file, std::string name);
  GzipReader(GzipReader&&) noexcept;
  ~GzipReader();

  /// Bytes of the content from `position` on: how many there are, up to the size of `to`. Where it is less, the
  /// checksum was compared too. Throws IoError for damaged and truncated data.
  std::size_t read(std::uint64_t position, std::span<char> to);

 private:
  struct State;

  void go_to(std::uint64_t position);
  std::size_t inflate_some(std::span<char> to);

  OpenFile file_;
  std::string name_;
  std::unique_ptr<State> state_;
  std::vector<std::unique_ptr<State>> kept_;  // in the order of the content
  std::vector<char> input_;
};

/// Compresses what is written to a file, with the bytes of deflate_bytes().
class GzipWriter {
 public:
  explicit GzipWriter(AtomicFile& file);
  GzipWriter(GzipWriter&&) noexcept;
  ~GzipWriter();

  void write(std::string_view bytes);
  /// After all of them.
  void finish();

 private:
  struct State;

  void deflate_to_file(int flush);

  AtomicFile& file_;
  std::unique_ptr<State> state_;
};

}  // namespace csrbf
