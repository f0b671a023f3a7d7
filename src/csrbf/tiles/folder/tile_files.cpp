#include "csrbf/tiles/folder/tile_files.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/atomic_file.hpp"
#include "csrbf/io/files/bytes.hpp"
#include "csrbf/io/files/open_file.hpp"

#include <cerrno>
#include <memory>

namespace csrbf {
namespace {

constexpr std::size_t buffered = std::size_t{64} << 20;  // bytes in the buffers of a dealer in all
constexpr Index block_points = 4096;                     // with a box of their own
constexpr std::string_view tile_magic = "csrbftil";

struct CloseTileFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using TileFile = std::unique_ptr<std::FILE, CloseTileFile>;

std::size_t point_bytes(bool normals) {
  return 3 * sizeof(double) + (normals ? 3 * sizeof(float) : 0);
}

[[noreturn]] void fail(const std::string& path, const std::string& what) {
  throw IoError(path + ": " + what + (errno != 0 ? std::string(": ") + std::strerror(errno) : ""));
}

void append_point(std::string& out, const Point<3>& point, const Point<3>* normal) {
  for (int axis = 0; axis < 3; ++axis) append_scalar(out, point[axis]);
  for (int axis = 0; axis < 3 && normal != nullptr; ++axis) append_scalar(out, static_cast<float>((*normal)[axis]));
}

Point<3> load_point(const char* bytes) {
  return {load_scalar<double>(bytes), load_scalar<double>(bytes + 8), load_scalar<double>(bytes + 16)};
}

Point<3> load_normal(const char* bytes) {
  return {load_scalar<float>(bytes + 24), load_scalar<float>(bytes + 28), load_scalar<float>(bytes + 32)};
}

bool seek_forward(std::FILE* file, std::size_t bytes) {
#ifdef _WIN32
  return _fseeki64(file, static_cast<long long>(bytes), SEEK_CUR) == 0;
#else
  return fseeko(file, static_cast<off_t>(bytes), SEEK_CUR) == 0;
#endif
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
void append_level(const PointCloud& cloud, const std::vector<Index>& ids, std::string& out) {
  append_scalar(out, static_cast<std::int64_t>(ids.size()));
  for (Index begin = 0; begin < std::ssize(ids); begin += block_points) {
    Box<3> box;
    for (Index i = begin; i < std::min(begin + block_points, std::ssize(ids)); ++i)
      box.add(Point<3>(cloud.points.col(ids[i])));
    for (const Point<3>& corner : {box.lo, box.hi}) append_point(out, corner, nullptr);
  }
  for (const Index i : ids) {
    const Point<3> normal = cloud.has_normals() ? Point<3>(cloud.normals.col(i)) : Point<3>::Zero();
    append_point(out, cloud.points.col(i), cloud.has_normals() ? &normal : nullptr);
  }
}

}  // namespace

PointDealer::PointDealer(std::vector<std::string> paths, bool normals)
    : paths_(std::move(paths)),
      normals_(normals),
      buffers_(paths_.size()),
      most_(std::max<std::size_t>(1 << 14, buffered / std::max<std::size_t>(1, paths_.size()))) {
  for (const std::string& path : paths_) {
    errno = 0;
    if (TileFile(open_file(path, "wb")) == nullptr) fail(path, "cannot be written");
  }
}

void PointDealer::add(Index tile, const Point<3>& point, const Point<3>* normal) {
  append_point(buffers_[tile], point, normals_ ? normal : nullptr);
  if (buffers_[tile].size() >= most_) flush(tile);
}

void PointDealer::flush() {
  for (std::size_t tile = 0; tile < paths_.size(); ++tile) flush(static_cast<Index>(tile));
}

void PointDealer::flush(Index tile) {
  std::string& buffer = buffers_[tile];
  if (buffer.empty()) return;
  errno = 0;
  const TileFile file(open_file(paths_[tile], "ab"));
  if (file == nullptr || std::fwrite(buffer.data(), 1, buffer.size(), file.get()) != buffer.size() ||
      std::fflush(file.get()) != 0)
    fail(paths_[tile], "cannot be written");
  buffer.clear();
}

PointCloud read_raw_points(const std::vector<std::string>& paths, bool normals) {
  std::string bytes;
  for (const std::string& path : paths) {
    const TileFile file(open_file(path, "rb"));
    if (file == nullptr) continue;
    const std::size_t size = std::filesystem::file_size(utf8_path(path));
    bytes += read_bytes(file.get(), path, size);
  }
  const std::size_t each = point_bytes(normals);
  PointCloud cloud;
  const auto n = static_cast<Index>(bytes.size() / each);
  cloud.points.resize(3, n);
  cloud.normals.resize(3, normals ? n : 0);
  for (Index i = 0; i < n; ++i) {
    const char* at = bytes.data() + each * static_cast<std::size_t>(i);
    cloud.points.col(i) = load_point(at);
    if (normals) cloud.normals.col(i) = load_normal(at);
  }
  return cloud;
}

void write_tile_points(const std::string& path, const PointCloud& cloud, const ThinnedPoints& thinned) {
  AtomicFile file(path);
  std::string out(tile_magic);
  append_scalar(out, static_cast<std::int64_t>(cloud.has_normals() ? 1 : 0));
  append_scalar(out, static_cast<std::int64_t>(thinned.levels.size() + 1));
  append_level(cloud, thinned.order, out);
  file.write(out);
  for (const std::vector<Index>& level : thinned.levels) {
    std::vector<Index> ids;
    for (const Index i : level) ids.push_back(thinned.order[i]);
    out.clear();
    append_level(cloud, ids, out);
    file.write(out);
  }
  file.commit();
}

void read_tile_points(const std::string& path, int level, const std::function<bool(const Box<3>&)>& wants_box,
                      const std::function<bool(const Point<3>&)>& wants_point, GatheredPoints& out) {
  errno = 0;
  const TileFile file(open_file(path, "rb"));
  if (file == nullptr) fail(path, "cannot be read");
  if (read_bytes(file.get(), path, tile_magic.size()) != tile_magic) fail(path, "is no tile");
  const bool normals = read_number(file.get(), path) != 0;
  const std::int64_t levels = read_number(file.get(), path);
  const std::size_t each = point_bytes(normals);
  for (int k = 0; k < std::min<std::int64_t>(level + 1, levels); ++k) {
    const std::int64_t count = read_number(file.get(), path);
    const std::int64_t blocks = (count + block_points - 1) / block_points;
    if (k < level) {
      if (!seek_forward(file.get(), static_cast<std::size_t>(blocks) * 48 + static_cast<std::size_t>(count) * each))
        fail(path, "the file is damaged or incomplete");
      continue;
    }
    const std::string boxes = read_bytes(file.get(), path, static_cast<std::size_t>(blocks) * 48);
    for (std::int64_t b = 0; b < blocks; ++b) {
      const char* at = boxes.data() + 48 * static_cast<std::size_t>(b);
      const auto points = static_cast<std::size_t>(std::min<std::int64_t>(block_points, count - b * block_points));
      if (!wants_box({load_point(at), load_point(at + 24)})) {
        if (!seek_forward(file.get(), points * each)) fail(path, "the file is damaged or incomplete");
        continue;
      }
      const std::string bytes = read_bytes(file.get(), path, points * each);
      for (std::size_t i = 0; i < points; ++i) {
        const Point<3> point = load_point(bytes.data() + i * each);
        if (!wants_point(point)) continue;
        out.points.insert(out.points.end(), point.begin(), point.end());
        if (!normals) continue;
        const Point<3> normal = load_normal(bytes.data() + i * each);
        out.normals.insert(out.normals.end(), normal.begin(), normal.end());
      }
    }
  }
}

}  // namespace csrbf
