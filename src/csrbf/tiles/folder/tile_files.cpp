#include "csrbf/tiles/folder/tile_files.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/atomic_file.hpp"
#include "csrbf/io/files/bytes.hpp"
#include "csrbf/io/files/open_file.hpp"

#include <cerrno>
#include <cstring>

namespace csrbf {
namespace {

constexpr std::size_t buffered = std::size_t{64} << 20;  // bytes in the buffers of a dealer in all
constexpr Index block_points = 4096;                     // with a box of their own
constexpr std::string_view tile_magic = "csrbftil";

[[noreturn]] void fail(const std::string& path, const std::string& what) {
  throw IoError(path + ": " + what + (errno != 0 ? std::string(": ") + std::strerror(errno) : ""));
}

template <int Dim>
void append_point(std::string& out, const Point<Dim>& point) {
  for (const double x : point) append_scalar(out, x);
}

template <int Dim, class Coordinate = double>
Point<Dim> load_point(const char* bytes) {
  Point<Dim> point;
  for (int axis = 0; axis < Dim; ++axis) point[axis] = load_scalar<Coordinate>(bytes + sizeof(Coordinate) * axis);
  return point;
}

// Whether single precision holds the coordinates, as those of most scans.
bool fit_in_float(const std::vector<double>& coordinates) {
  return std::all_of(coordinates.begin(), coordinates.end(),
                     [](double x) { return static_cast<double>(static_cast<float>(x)) == x; });
}

bool skip(std::FILE* file, std::size_t bytes) {
  return seek_file(file, static_cast<std::int64_t>(bytes), SEEK_CUR);
}

std::string read_bytes(std::FILE* file, const std::string& path, std::size_t count) {
  std::string bytes(count, '\0');
  errno = 0;
  if (std::fread(bytes.data(), 1, count, file) != count) fail(path, "the file is damaged or incomplete");
  return bytes;
}

std::int64_t read_number(std::FILE* file, const std::string& path) {
  const std::string bytes = read_bytes(file, path, 8);
  return load_scalar<std::int64_t>(bytes.data());
}

// Appends a level: the number of its points, the boxes of its blocks, its points.
template <class Coordinate, int Dim>
void append_level(const Records<Dim>& records, const std::vector<Index>& ids, std::string& out) {
  const auto points = records.matrix();
  append_scalar(out, static_cast<std::int64_t>(ids.size()));
  for (Index begin = 0; begin < std::ssize(ids); begin += block_points) {
    Box<Dim> box;
    for (Index i = begin; i < std::min(begin + block_points, std::ssize(ids)); ++i)
      box.add(Point<Dim>(points.col(ids[i])));
    append_point<Dim>(out, box.lo);
    append_point<Dim>(out, box.hi);
  }
  constexpr std::size_t point_size = Dim * sizeof(Coordinate);
  const std::size_t each = point_size + records.each, before = out.size();
  out.resize(before + each * ids.size());
  char* at = out.data() + before;
  for (const Index i : ids) {
    const Eigen::Matrix<Coordinate, Dim, 1> point = points.col(i).template cast<Coordinate>();
    std::memcpy(at, point.data(), point_size);
    std::memcpy(at + point_size, records.payload_of(i).data(), records.each);
    at += each;
  }
}

// Where the records of a tile are read.
struct TileReader {
  std::FILE* file;
  const std::string& path;

  void skip_bytes(std::size_t count) const {
    if (!skip(file, count)) fail(path, "the file is damaged or incomplete");
  }
};

// The blocks of a level that are wanted, see read_tile().
template <class Coordinate, int Dim>
void read_level(const TileReader& reader, std::int64_t count, const std::function<bool(const Box<Dim>&)>& wants_box,
                const std::function<bool(const Point<Dim>&)>& wants_point, Records<Dim>& out) {
  constexpr std::size_t point_size = Dim * sizeof(Coordinate), corner_size = Dim * sizeof(double);
  const std::size_t each = point_size + out.each;
  const std::int64_t blocks = (count + block_points - 1) / block_points;
  const std::string boxes = read_bytes(reader.file, reader.path, 2 * corner_size * static_cast<std::size_t>(blocks));
  for (std::int64_t b = 0; b < blocks; ++b) {
    const char* at = boxes.data() + 2 * corner_size * static_cast<std::size_t>(b);
    const auto points = static_cast<std::size_t>(std::min<std::int64_t>(block_points, count - b * block_points));
    if (!wants_box({load_point<Dim>(at), load_point<Dim>(at + corner_size)})) {
      reader.skip_bytes(points * each);
      continue;
    }
    const std::string bytes = read_bytes(reader.file, reader.path, points * each);
    for (std::size_t i = 0; i < points; ++i) {
      const char* record = bytes.data() + i * each;
      const Point<Dim> point = load_point<Dim, Coordinate>(record);
      if (wants_point(point)) out.add(point, {record + point_size, out.each});
    }
  }
}

}  // namespace

template <int Dim>
std::vector<Index> take_numbers(Records<Dim>& records) {
  const std::size_t all = records.each, left = all - sizeof(std::int64_t);
  std::vector<Index> numbers(records.size());
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const char* payload = records.payload.data() + all * i;
    numbers[i] = load_scalar<std::int64_t>(payload + left);
    std::memmove(records.payload.data() + left * i, payload, left);
  }
  records.payload.resize(left * numbers.size());
  records.each = left;
  return numbers;
}

RecordDealer::RecordDealer(std::vector<std::string> paths)
    : paths_(std::move(paths)),
      buffers_(paths_.size()),
      begun_(paths_.size()),
      most_(std::max<std::size_t>(1 << 14, buffered / std::max<std::size_t>(1, paths_.size()))) {}

template <int Dim>
void RecordDealer::add(Index tile, const Point<Dim>& point, std::string_view payload) {
  append_point<Dim>(buffers_[tile], point);
  buffers_[tile] += payload;
  if (buffers_[tile].size() >= most_) flush(tile);
}

void RecordDealer::flush() {
  for (std::size_t tile = 0; tile < paths_.size(); ++tile) flush(static_cast<Index>(tile));
}

void RecordDealer::flush(Index tile) {
  std::string& buffer = buffers_[tile];
  if (buffer.empty()) return;
  errno = 0;
  const OpenFile file(open_file(paths_[tile], begun_[tile] != 0 ? "ab" : "wb"));
  if (file == nullptr || std::fwrite(buffer.data(), 1, buffer.size(), file.get()) != buffer.size() ||
      std::fflush(file.get()) != 0)
    fail(paths_[tile], "cannot be written");
  begun_[tile] = 1;
  buffer.clear();
}

template <int Dim>
Records<Dim> read_raw_records(const std::vector<std::string>& paths, std::size_t payload) {
  Records<Dim> records;
  records.each = payload;
  const std::size_t each = Dim * sizeof(double) + payload;
  for (const std::string& path : paths) {
    const OpenFile file(open_file(path, "rb"));
    if (file == nullptr) continue;
    const std::size_t size = std::filesystem::file_size(utf8_path(path));
    const std::string bytes = read_bytes(file.get(), path, size);
    const std::size_t count = size / each, before = records.points.size();
    records.points.resize(before + Dim * count);
    records.payload.resize(records.payload.size() + payload * count);
    char* points = reinterpret_cast<char*>(records.points.data() + before);
    char* rest = records.payload.data() + records.payload.size() - payload * count;
    for (std::size_t i = 0; i < count; ++i) {
      std::memcpy(points + Dim * sizeof(double) * i, bytes.data() + each * i, Dim * sizeof(double));
      std::memcpy(rest + payload * i, bytes.data() + each * i + Dim * sizeof(double), payload);
    }
  }
  return records;
}

template <int Dim>
void write_tile(const std::string& path, const Records<Dim>& records, const ThinnedPoints& thinned) {
  AtomicFile file(path);
  const bool narrow = fit_in_float(records.points);
  const auto level = [&](const std::vector<Index>& ids, std::string& out) {
    narrow ? append_level<float>(records, ids, out) : append_level<double>(records, ids, out);
  };
  std::string out(tile_magic);
  append_scalar(out, static_cast<std::int64_t>(records.each));
  append_scalar(out, static_cast<std::int64_t>(narrow ? sizeof(float) : sizeof(double)));
  append_scalar(out, static_cast<std::int64_t>(thinned.levels.size() + 1));
  level(thinned.order, out);
  file.write(out);
  for (const std::vector<Index>& thin : thinned.levels) {
    std::vector<Index> ids;
    ids.reserve(thin.size());
    for (const Index i : thin) ids.push_back(thinned.order[i]);
    out.clear();
    level(ids, out);
    file.write(out);
  }
  file.commit();
}

template <int Dim>
void read_tile(const std::string& path, int level, const std::function<bool(const Box<Dim>&)>& wants_box,
               const std::function<bool(const Point<Dim>&)>& wants_point, Records<Dim>& out) {
  errno = 0;
  const OpenFile file(open_file(path, "rb"));
  if (file == nullptr) fail(path, "cannot be read");
  if (read_bytes(file.get(), path, tile_magic.size()) != tile_magic) fail(path, "is no tile");
  const TileReader reader{file.get(), path};
  const std::int64_t payload = read_number(file.get(), path);
  if (payload != static_cast<std::int64_t>(out.each)) fail(path, "is a tile of other work");
  const auto coordinate = static_cast<std::size_t>(read_number(file.get(), path));
  const std::int64_t levels = read_number(file.get(), path);
  for (int k = 0; k < std::min<std::int64_t>(level + 1, levels); ++k) {
    const std::int64_t count = read_number(file.get(), path);
    const auto blocks = static_cast<std::size_t>((count + block_points - 1) / block_points);
    if (k < level)
      reader.skip_bytes(blocks * 2 * Dim * sizeof(double) +
                        static_cast<std::size_t>(count) * (Dim * coordinate + out.each));
    else if (coordinate == sizeof(float))
      read_level<float>(reader, count, wants_box, wants_point, out);
    else
      read_level<double>(reader, count, wants_box, wants_point, out);
  }
}

#define CSRBF_INSTANTIATE(Dim)                                                                       \
  template std::vector<Index> take_numbers<Dim>(Records<Dim>&);                                      \
  template void RecordDealer::add<Dim>(Index, const Point<Dim>&, std::string_view);                  \
  template Records<Dim> read_raw_records<Dim>(const std::vector<std::string>&, std::size_t);         \
  template void write_tile<Dim>(const std::string&, const Records<Dim>&, const ThinnedPoints&);      \
  template void read_tile<Dim>(const std::string&, int, const std::function<bool(const Box<Dim>&)>&, \
                               const std::function<bool(const Point<Dim>&)>&, Records<Dim>&);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
