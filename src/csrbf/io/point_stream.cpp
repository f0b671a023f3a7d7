#include "csrbf/io/point_stream.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/npy.hpp"
#include "csrbf/io/files/open_file.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/geometry/ply_header.hpp"
#include "csrbf/io/points.hpp"

#include <filesystem>

namespace csrbf {
namespace {

constexpr std::size_t longest_header = 1 << 16;  // bytes; files with longer ones are read whole

std::string read_up_to(std::FILE* file, std::size_t bytes) {
  std::string text(bytes, '\0');
  text.resize(std::fread(text.data(), 1, bytes, file));
  return text;
}

}  // namespace

PointStream::PointStream(const std::string& path) : path_(path), extension_(file_extension(path)) {
  if (extension_ == ".ply" || extension_ == ".npy") {
    file_.reset(open_file(path, "rb"));
    if (file_ != nullptr) {
      const std::string start = read_up_to(file_.get(), longest_header);
      if (extension_ == ".ply" ? open_ply(start) : open_npy(start)) return;
    }
    file_.reset();
  }
  all_ = read_points(path);
  size_ = all_.size();
}

// A .ply file of some of the points is their bytes behind a header with their number.
bool PointStream::open_ply(std::string_view start) {
  const std::size_t mark = start.find("\nend_header");
  const std::size_t line_end = mark == std::string_view::npos ? mark : start.find('\n', mark + 1);
  if (line_end == std::string_view::npos) return false;
  LineReader reader(start.substr(0, line_end + 1), path_);
  const PlyHeader header = parse_ply_header(reader);
  if (header.encoding == PlyEncoding::ascii || header.elements.empty()) return false;
  const PlyElement& vertex = header.elements.front();
  if (vertex.name != "vertex" || vertex.has_lists()) return false;
  data_begin_ = line_end + 1;
  point_size_ = vertex.smallest_binary_size();
  size_ = vertex.count;
  const bool little = header.encoding == PlyEncoding::little_endian;
  before_count_ =
      std::string("ply\nformat ") + (little ? "binary_little_endian" : "binary_big_endian") + " 1.0\nelement vertex ";
  after_count_ = "\n";
  constexpr std::string_view names[] = {"uchar", "char",  "ushort", "short", "uint",
                                        "int",   "ulong", "long",   "float", "double"};
  for (const PlyProperty& p : vertex.properties)
    after_count_ += "property " + std::string(names[static_cast<std::size_t>(p.type)]) + " " + p.name + "\n";
  after_count_ += "end_header\n";
  return std::filesystem::file_size(utf8_path(path_)) >= data_begin_ + point_size_ * static_cast<std::size_t>(size_);
}

bool PointStream::open_npy(std::string_view start) {
  std::string_view rest = start;
  const NpyHeader header = parse_npy_header(rest, path_);
  if (header.shape.size() != 2 || header.fortran || (header.shape[1] != 3 && header.shape[1] != 6)) return false;
  if (header.order != std::endian::little) return false;
  data_begin_ = start.size() - rest.size();
  point_size_ = sample_size(header.type) * static_cast<std::size_t>(header.shape[1]);
  size_ = header.shape[0];
  before_count_ = format_npy_header(header.type, {0, header.shape[1]});
  return std::filesystem::file_size(utf8_path(path_)) >= data_begin_ + point_size_ * static_cast<std::size_t>(size_);
}

PointCloud PointStream::read(Index begin, Index end) {
  require(0 <= begin && begin <= end && end <= size_, "PointStream", "end", end, "must be within the points");
  if (file_ == nullptr) {
    const Index n = end - begin;
    PointCloud part;
    part.points = all_.points.middleCols(begin, n);
    if (all_.has_normals()) part.normals = all_.normals.middleCols(begin, n);
    for (const Property& p : all_.properties) part.properties.push_back({p.name, p.type, p.values.segment(begin, n)});
    return part;
  }
  std::string bytes;
  if (extension_ == ".ply") {
    bytes = before_count_ + std::to_string(end - begin) + after_count_;
  } else {
    std::string_view none = before_count_;
    const NpyHeader header = parse_npy_header(none, path_);
    bytes = format_npy_header(header.type, {end - begin, header.shape[1]});
  }
  const std::size_t wanted = point_size_ * static_cast<std::size_t>(end - begin);
  const std::size_t at = data_begin_ + point_size_ * static_cast<std::size_t>(begin);
  if (!seek_file(file_.get(), static_cast<std::int64_t>(at), SEEK_SET))
    throw IoError(path_ + ": cannot move to point " + std::to_string(begin));
  const std::string data = read_up_to(file_.get(), wanted);
  if (data.size() < wanted) throw IoError(path_ + ": the file ends before point " + std::to_string(end));
  return parse_points(extension_, bytes + data, path_);
}

}  // namespace csrbf
