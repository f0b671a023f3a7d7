#include "csrbf/io/models/archive.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/atomic_file.hpp"
#include "csrbf/io/files/bytes.hpp"
#include "csrbf/io/files/open_file.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/models/tile_store.hpp"

#include <zlib.h>

#include <functional>

namespace csrbf {
namespace {

// Transfers in text mode damage the control characters, and so are detected.
constexpr std::string_view magic{"CSRBF\r\n\x1a", 8};
constexpr std::size_t size_offset = magic.size() + 4;
constexpr std::size_t head_size = size_offset + 8;
constexpr std::size_t checksum_size = 4;

std::uint32_t checksum(std::string_view bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

void append_text(std::string& out, const std::string& text) {
  append_scalar(out, static_cast<std::uint32_t>(text.size()));
  out += text;
}

// Of one entry, in pieces, so that arrays need no copy.
struct ValueWriter {
  const std::function<void(std::string_view)>& put;

  void operator()(double value) const { put_scalar(value); }
  void operator()(std::int64_t value) const { put_scalar(value); }
  void operator()(const std::string& value) const {
    std::string bytes;
    append_text(bytes, value);
    put(bytes);
  }
  template <class T>
  void operator()(const ArchiveArray<T>& array) const {
    put_scalar(static_cast<std::uint64_t>(array.rows()));
    put_scalar(static_cast<std::uint64_t>(array.cols()));
    if constexpr (std::endian::native == std::endian::little)
      put({reinterpret_cast<const char*>(array.data()), sizeof(T) * static_cast<std::size_t>(array.size())});
    else
      for (Index i = 0; i < array.size(); ++i) put_scalar(array.data()[i]);
  }
  template <class T>
  void put_scalar(T value) const {
    std::string bytes;
    append_scalar(bytes, value);
    put(bytes);
  }
};

// All bytes but the checksum.
void put_archive(const Archive& archive, std::uint64_t size, const std::function<void(std::string_view)>& put) {
  std::string bytes(magic);
  append_scalar(bytes, static_cast<std::uint32_t>(archive_format));
  append_scalar(bytes, size);
  append_text(bytes, archive.kind);
  append_scalar(bytes, static_cast<std::uint64_t>(archive.values().size()));
  put(bytes);
  for (const auto& [name, value] : archive.values()) {
    bytes.clear();
    append_text(bytes, name);
    append_scalar(bytes, static_cast<std::uint8_t>(value.index()));
    put(bytes);
    std::visit(ValueWriter{put}, value);
  }
}

// The same with the checksum.
void put_all(const Archive& archive, const std::function<void(std::string_view)>& put) {
  std::uint64_t size = checksum_size;
  put_archive(archive, 0, [&](std::string_view bytes) { size += bytes.size(); });
  uLong sum = 0;
  put_archive(archive, size, [&](std::string_view bytes) {
    if (bytes.empty()) return;
    sum = crc32_z(sum, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
    put(bytes);
  });
  std::string end;
  append_scalar(end, static_cast<std::uint32_t>(sum));
  put(end);
}

// Reads values, never beyond the end.
class Reader {
 public:
  Reader(std::string_view bytes, std::string name) : bytes_(bytes), name_(std::move(name)) {}

  template <class T>
  T scalar() {
    return load_scalar<T>(take(sizeof(T)).data());
  }
  std::string text() {
    const std::size_t size = scalar<std::uint32_t>();
    return std::string(take(size));
  }
  template <class T>
  ArchiveArray<T> array() {
    const auto rows = scalar<std::uint64_t>();
    const auto cols = scalar<std::uint64_t>();
    const std::size_t room = bytes_.size() / sizeof(T);
    // An empty array may have one long side, but not longer than an index can hold.
    constexpr auto longest =
        static_cast<std::uint64_t>(index_limit(std::int64_t{std::numeric_limits<std::int32_t>::max()} * 1024));
    if (rows > longest || cols > longest || (rows > 0 && cols > room / rows)) fail("an array is larger than the file");
    ArchiveArray<T> array(static_cast<Index>(rows), static_cast<Index>(cols));
    const std::string_view data = take(sizeof(T) * static_cast<std::size_t>(array.size()));
    if constexpr (std::endian::native == std::endian::little) {
      if (!data.empty()) std::memcpy(array.data(), data.data(), data.size());
    } else {
      for (Index i = 0; i < array.size(); ++i) array.data()[i] = load_scalar<T>(data.data() + sizeof(T) * i);
    }
    return array;
  }
  [[nodiscard]] bool at_end() const { return bytes_.empty(); }
  [[noreturn]] void fail(const std::string& what) const { throw IoError(name_ + ": the file is damaged: " + what); }

 private:
  std::string_view take(std::size_t size) {
    if (size > bytes_.size()) fail("an entry runs over its end");
    const std::string_view taken = bytes_.substr(0, size);
    bytes_.remove_prefix(size);
    return taken;
  }

  std::string_view bytes_;
  std::string name_;
};

template <std::size_t Type = 0>
Archive::Value read_value(Reader& reader, std::size_t type) {
  if constexpr (Type == std::variant_size_v<Archive::Value>) {
    reader.fail("an entry is of an unknown type");
  } else {
    using T = std::variant_alternative_t<Type, Archive::Value>;
    if (type != Type) return read_value<Type + 1>(reader, type);
    if constexpr (std::is_arithmetic_v<T>)
      return reader.scalar<T>();
    else if constexpr (std::is_same_v<T, std::string>)
      return reader.text();
    else
      return reader.array<typename T::Scalar>();
  }
}

// Everything that can be checked before the entries are read.
void check_file(std::string_view bytes, const std::string& name) {
  if (bytes.empty()) throw IoError(name + ": the file is empty");
  if (!bytes.starts_with(magic)) throw IoError(name + ": not a csrbf model");
  if (bytes.size() < head_size + checksum_size) throw IoError(name + ": the file is truncated");
  const auto format = load_scalar<std::uint32_t>(bytes.data() + magic.size());
  if (format > static_cast<std::uint32_t>(archive_format))
    throw IoError(name + ": written by a newer csrbf (format " + std::to_string(format) +
                  ", this program reads up to " + std::to_string(archive_format) + ")");
  const auto size = load_scalar<std::uint64_t>(bytes.data() + size_offset);
  if (size > bytes.size())
    throw IoError(name + ": the file is truncated: " + std::to_string(bytes.size()) + " of " + std::to_string(size) +
                  " bytes");
  const std::size_t checked = bytes.size() - checksum_size;
  if (format == 0 || size != bytes.size() ||
      checksum(bytes.substr(0, checked)) != load_scalar<std::uint32_t>(bytes.data() + checked))
    throw IoError(name + ": the file is damaged: its checksum does not match");
}

// The size of an archive that is followed by others in its file; 0: there are none, or it is no archive.
std::size_t size_before_tiles(const std::string& path) {
  std::error_code error;
  if (path == "-" || !std::filesystem::is_regular_file(utf8_path(path), error)) return 0;
  const OpenFile file(open_file(path, "rb"));
  std::string head(head_size, '\0');
  if (file == nullptr || std::fread(head.data(), 1, head_size, file.get()) != head_size || !head.starts_with(magic))
    return 0;
  const auto size = load_scalar<std::uint64_t>(head.data() + size_offset);
  const std::uintmax_t whole = std::filesystem::file_size(utf8_path(path), error);
  return !error && size < whole && size >= head_size + checksum_size ? static_cast<std::size_t>(size) : 0;
}

}  // namespace

void Archive::set(const std::string& prefix, Archive part) {
  for (auto& [name, value] : part.values_) values_[prefix + "/" + name] = std::move(value);
  values_[prefix + "/kind"] = std::move(part.kind);
}

std::int64_t Archive::integer(const std::string& name, std::int64_t lo, std::int64_t hi) const {
  const std::int64_t value = integer(name);
  if (value < lo || value > hi)
    fail("entry \"" + name + "\" = " + std::to_string(value) + " is not in [" + std::to_string(lo) + ", " +
         std::to_string(hi) + "]");
  return value;
}

const ArchiveArray<double>& Archive::numbers(const std::string& name, Index rows, Index cols) const {
  const ArchiveArray<double>& found = array<double>(name, rows, cols);
  if (!found.allFinite()) fail("\"" + name + "\" holds NaN or infinity");
  return found;
}

std::vector<double> Archive::column(const std::string& name, Index rows) const {
  const auto& found = numbers(name, rows, 1);
  return {found.data(), found.data() + found.size()};
}

Archive Archive::part(const std::string& prefix) const {
  const std::string start = prefix + "/";
  Archive found;
  found.kind = text(start + "kind");
  found.source = source;
  for (auto it = values_.lower_bound(start); it != values_.end() && it->first.starts_with(start); ++it)
    if (it->first != start + "kind") found.values_[it->first.substr(start.size())] = it->second;
  return found;
}

void Archive::fail(const std::string& message) const {
  throw IoError((source.empty() ? "model" : source) + ": " + message);
}

void Archive::check_shape(const std::string& name, Index rows, Index cols, Index expected_rows,
                          Index expected_cols) const {
  const bool fits = (expected_rows < 0 || rows == expected_rows) && (expected_cols < 0 || cols == expected_cols);
  const auto side = [](Index n) { return n < 0 ? std::string("any") : std::to_string(n); };
  if (!fits)
    fail("entry \"" + name + "\" has " + std::to_string(rows) + " x " + std::to_string(cols) + " values, expected " +
         side(expected_rows) + " x " + side(expected_cols));
}

std::string format_archive(const Archive& archive) {
  std::string out;
  put_all(archive, [&](std::string_view bytes) { out += bytes; });
  return out;
}

Archive parse_archive(std::string_view bytes, const std::string& name) {
  check_file(bytes, name);
  Reader reader(bytes.substr(head_size, bytes.size() - head_size - checksum_size), name);
  Archive archive;
  archive.source = name;
  archive.file_size = static_cast<std::int64_t>(bytes.size());
  archive.kind = reader.text();
  const auto entries = reader.scalar<std::uint64_t>();
  for (std::uint64_t i = 0; i < entries; ++i) {
    const std::string entry = reader.text();
    archive.insert(entry, read_value(reader, reader.scalar<std::uint8_t>()));
  }
  if (!reader.at_end()) reader.fail("there are bytes after the last entry");
  return archive;
}

void write_archive(const std::string& path, const Archive& archive) {
  if (path == "-") return write_file(path, format_archive(archive));
  AtomicFile file(path);
  put_all(archive, [&](std::string_view bytes) { file.write(bytes); });
  file.commit();
}

Archive read_archive(const std::string& path) {
  const std::size_t size = size_before_tiles(path);
  if (size == 0) return parse_archive(read_file(path), display_name(path));
  std::string bytes(size, '\0');
  const OpenFile file(open_file(path, "rb"));
  if (file == nullptr || std::fread(bytes.data(), 1, size, file.get()) != size)
    throw IoError(path + ": the file cannot be read");
  Archive archive = parse_archive(bytes, path);
  const std::int64_t behind = static_cast<std::int64_t>(std::filesystem::file_size(utf8_path(path)) - size);
  if (!archive.has(tile_sizes_entry) || archive.array<std::int64_t>(tile_sizes_entry, -1, 1).sum() != behind)
    archive.fail("the file is damaged: " + std::to_string(behind) + " bytes behind the model belong to nothing");
  return archive;
}

}  // namespace csrbf
