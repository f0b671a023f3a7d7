#include "csrbf/io/geometry/formats.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/interruption.hpp"
#include "csrbf/io/files/bytes.hpp"
#include "csrbf/io/files/text.hpp"

#include <Eigen/Geometry>

namespace csrbf {
namespace {

constexpr unsigned triangles_between_breaks = 1U << 12;  // triangles
constexpr std::size_t head_size = 84;
constexpr std::size_t triangle_size = 50;

// Gives equal corners the same number: open addressing over the bits of the coordinates.
class VertexNumbers {
 public:
  explicit VertexNumbers(std::size_t corners) : slots_(std::bit_ceil(2 * corners + 1), unused) {}

  std::int32_t number(const Point<3>& p) {
    const std::size_t mask = slots_.size() - 1;
    for (std::size_t slot = hash(p) & mask;; slot = (slot + 1) & mask) {
      if (slots_[slot] == unused) {
        slots_[slot] = static_cast<std::int32_t>(positions_.size() / 3);
        positions_.insert(positions_.end(), p.begin(), p.end());
        return slots_[slot];
      }
      if (position(slots_[slot]) == p) return slots_[slot];
    }
  }

  [[nodiscard]] Points<3> vertices() const {
    return Eigen::Map<const Points<3>>(positions_.data(), 3, static_cast<Index>(positions_.size() / 3));
  }

 private:
  static constexpr std::int32_t unused = -1;

  [[nodiscard]] Eigen::Map<const Point<3>> position(std::int32_t vertex) const {
    return Eigen::Map<const Point<3>>(positions_.data() + 3 * std::ptrdiff_t{vertex});
  }

  // Multiplicative mixing of the three words; adding zero makes -0 and +0 the same.
  static std::size_t hash(const Point<3>& p) {
    std::uint64_t h = 0;
    for (const double coordinate : p) {
      h ^= bit_cast<std::uint64_t>(coordinate + 0.0);
      h *= 0x9E3779B97F4A7C15u;
      h ^= h >> 32;
    }
    return static_cast<std::size_t>(h);
  }

  std::vector<std::int32_t> slots_;
  std::vector<double> positions_;
};

Mesh parse_binary(std::string_view bytes, const std::string& name) {
  const std::size_t triangles = load_scalar<std::uint32_t>(bytes.data() + head_size - 4);
  if (triangles > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()) / 3)
    throw IoError(name + ": more than 2^31 - 1 corners");
  Mesh mesh;
  mesh.triangles.resize(3, triangles);
  VertexNumbers numbers(3 * triangles);
  constexpr std::size_t normal_size = 12;
  InterruptionPoint pause(triangles_between_breaks);
  for (Index t = 0; t < mesh.triangles.cols(); ++t) {
    pause();
    const char* corner = bytes.data() + head_size + t * triangle_size + normal_size;
    for (int c = 0; c < 3; ++c, corner += 12) {
      Point<3> p;
      for (int axis = 0; axis < 3; ++axis) p(axis) = static_cast<double>(load_scalar<float>(corner + 4 * axis));
      mesh.triangles(c, t) = numbers.number(p);
    }
  }
  mesh.vertices = numbers.vertices();
  return mesh;
}

Point<3> read_corner(const LineReader& reader, std::string_view rest) {
  Point<3> p;
  for (int axis = 0; axis < 3; ++axis) {
    const std::string_view word = take_word(rest);
    if (word.empty()) reader.fail("expected 3 coordinates, found " + std::to_string(axis));
    p(axis) = reader.number(word);
  }
  return p;
}

Mesh parse_text(std::string_view text, const std::string& name) {
  LineReader reader(text, name);
  constexpr std::size_t shortest_vertex = 12;  // "vertex 0 0 0"
  VertexNumbers numbers(text.size() / shortest_vertex + 1);
  std::vector<std::int32_t> corners;
  std::size_t corners_of_facet = 0;
  bool ended = false;
  while (reader.next()) {
    std::string_view rest = reader.line();
    const std::string keyword = lower_case(take_word(rest));
    if (keyword == "vertex") {
      corners.push_back(numbers.number(read_corner(reader, rest)));
      ++corners_of_facet;
    } else if (keyword == "endfacet") {
      if (corners_of_facet != 3)
        reader.fail("expected 3 vertices in the facet, found " + std::to_string(corners_of_facet));
      corners_of_facet = 0;
    }
    ended = keyword == "endsolid";
  }
  if (!ended) reader.fail("the file ends before endsolid");
  if (corners.size() % 3 != 0) reader.fail("a facet is not closed");
  Mesh mesh;
  mesh.vertices = numbers.vertices();
  mesh.triangles = Eigen::Map<const Triangles>(corners.data(), 3, static_cast<Index>(corners.size() / 3));
  return mesh;
}

}  // namespace

Mesh parse_stl(std::string_view bytes, const std::string& name) {
  if (bytes.empty()) throw IoError(name + ": the file is empty");
  // Binary files may begin with "solid" too: the size decides.
  const bool has_head = bytes.size() >= head_size;
  const std::size_t triangles = has_head ? load_scalar<std::uint32_t>(bytes.data() + head_size - 4) : 0;
  const std::size_t needed = head_size + triangle_size * triangles;
  if (has_head && bytes.size() == needed) return parse_binary(bytes, name);
  const bool is_text = bytes.find('\0') == std::string_view::npos;
  if (is_text && lower_case(trimmed(bytes.substr(0, head_size))).starts_with("solid")) return parse_text(bytes, name);
  // A few bytes behind the triangles, as some programs write, are no triangle.
  if (has_head && bytes.size() > needed && bytes.size() < needed + triangle_size) return parse_binary(bytes, name);
  if (!has_head) throw IoError(name + ": not an STL file");
  throw IoError(name + ": the header promises " + std::to_string(triangles) + " triangles, the file has room for " +
                std::to_string((bytes.size() - head_size) / triangle_size));
}

std::string format_stl(const Mesh& mesh) {
  std::string out = "binary STL";  // must not begin with "solid"
  out.resize(head_size - 4, ' ');
  append_scalar(out, static_cast<std::uint32_t>(mesh.triangles.cols()));
  out.reserve(head_size + triangle_size * mesh.triangles.cols());
  InterruptionPoint pause(triangles_between_breaks);
  for (Index t = 0; t < mesh.triangles.cols(); ++t) {
    pause();
    const Point<3> a = mesh.vertices.col(mesh.triangles(0, t));
    const Point<3> b = mesh.vertices.col(mesh.triangles(1, t));
    const Point<3> c = mesh.vertices.col(mesh.triangles(2, t));
    const Point<3> normal = (b - a).cross(c - a).stableNormalized();
    for (const Point<3>& p : {normal, a, b, c})
      for (int axis = 0; axis < 3; ++axis) append_scalar(out, narrow_scalar<float>(p(axis)));
    append_scalar(out, std::uint16_t{0});
  }
  return out;
}

}  // namespace csrbf
