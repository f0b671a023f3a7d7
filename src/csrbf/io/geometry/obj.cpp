#include "csrbf/io/geometry/formats.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/interruption.hpp"
#include "csrbf/io/files/text.hpp"
#include "csrbf/io/geometry/properties.hpp"

namespace csrbf {
namespace {

// Up to `most` numbers of a line.
int read_numbers(const LineReader& reader, std::string_view rest, double* out, int most) {
  int found = 0;
  for (std::string_view word = take_word(rest); !word.empty() && found < most; word = take_word(rest))
    out[found++] = reader.number(word);
  return found;
}

class ObjParser {
 public:
  ObjParser(std::string_view text, const std::string& name) : reader_(text, name, '#') {}

  Mesh parse() {
    read();
    return finish();
  }

  Polylines parse_polylines() {
    Mesh mesh = parse();
    Polylines lines;
    lines.vertices = std::move(mesh.vertices);
    lines.properties = std::move(mesh.properties);
    lines.edges = Eigen::Map<const Eigen::Matrix<std::int32_t, 2, Eigen::Dynamic>>(
        ends_.data(), 2, static_cast<Index>(ends_.size() / 2));
    return lines;
  }

 private:
  void read() {
    while (reader_.next()) {
      std::string_view rest = reader_.line();
      const std::string_view keyword = take_word(rest);
      if (keyword == "v")
        read_vertex(rest);
      else if (keyword == "vn")
        read_normal(rest);
      else if (keyword == "f")
        read_face(rest);
      else if (keyword == "l")
        read_line(rest);
    }
  }

  void read_vertex(std::string_view rest) {
    std::array<double, 7> numbers{};
    const int found = read_numbers(reader_, rest, numbers.data(), 7);
    if (found < 3) reader_.fail("expected 3 coordinates, found " + std::to_string(found));
    positions_.insert(positions_.end(), numbers.begin(), numbers.begin() + 3);
    // x y z [w] r g b
    if (found >= 6) colors_.insert(colors_.end(), numbers.begin() + found - 3, numbers.begin() + found);
  }

  void read_normal(std::string_view rest) {
    std::array<double, 3> numbers{};
    const int found = read_numbers(reader_, rest, numbers.data(), 3);
    if (found < 3) reader_.fail("expected 3 components of a normal, found " + std::to_string(found));
    normals_.insert(normals_.end(), numbers.begin(), numbers.end());
  }

  void read_face(std::string_view rest) {
    element_ = "face " + std::to_string(++faces_);
    std::int32_t first = 0;
    std::int32_t previous = 0;
    int corner = 0;
    for (std::string_view word = take_word(rest); !word.empty(); word = take_word(rest), ++corner) {
      const std::int32_t index = read_corner(word);
      if (corner == 0) first = index;
      if (corner >= 2) corners_.insert(corners_.end(), {first, previous, index});
      previous = index;
    }
    if (corner < 3) reader_.fail(element_ + " has " + std::to_string(corner) + " corners");
  }

  void read_line(std::string_view rest) {
    element_ = "line " + std::to_string(++lines_);
    std::int32_t previous = 0;
    int count = 0;
    for (std::string_view word = take_word(rest); !word.empty(); word = take_word(rest), ++count) {
      const std::int32_t index = read_corner(word);
      if (count > 0) ends_.insert(ends_.end(), {previous, index});
      previous = index;
    }
    if (count < 2) reader_.fail(element_ + " has " + std::to_string(count) + " vertices");
  }

  // v, v/t, v//n or v/t/n.
  std::int32_t read_corner(std::string_view word) {
    const std::size_t slash = std::min(word.find('/'), word.size());
    const std::int32_t vertex = resolve(word.substr(0, slash), word, positions_.size() / 3, "vertex");
    const std::size_t last_slash = word.rfind('/');
    if (last_slash != std::string_view::npos && last_slash != slash && last_slash + 1 < word.size()) {
      const std::int32_t normal = resolve(word.substr(last_slash + 1), word, normals_.size() / 3, "normal");
      normals_follow_vertices_ = normals_follow_vertices_ && normal == vertex;
    }
    return vertex;
  }

  // Zero-based index of an item declared before this line.
  std::int32_t resolve(std::string_view text, std::string_view word, std::size_t count, const char* what) const {
    const auto index = parse_integer(text);
    if (!index || *index == 0) reader_.fail(element_ + ": " + in_quotes(word) + " is not a vertex index");
    const auto available = static_cast<std::int64_t>(count);
    const std::int64_t position = *index > 0 ? *index - 1 : available + *index;
    if (position < 0 || position >= available)
      reader_.fail(element_ + ": " + what + " index " + std::to_string(*index) + " is not one of the " +
                   std::to_string(count) + " before it");
    return static_cast<std::int32_t>(position);
  }

  Mesh finish() {
    if (positions_.empty()) throw IoError(reader_.name() + ": the file has no vertices");
    const auto n = static_cast<Index>(positions_.size() / 3);
    if (n > std::numeric_limits<std::int32_t>::max()) throw IoError(reader_.name() + ": more than 2^31 - 1 vertices");
    Mesh mesh;
    mesh.vertices = Eigen::Map<const Points<3>>(positions_.data(), 3, n);
    if (normals_.size() == positions_.size() && normals_follow_vertices_)
      mesh.normals = Eigen::Map<const Points<3>>(normals_.data(), 3, n);
    if (colors_.size() == positions_.size())
      add_colors(Eigen::Map<const Eigen::MatrixXd>(colors_.data(), 3, n), mesh.properties);
    mesh.triangles = Eigen::Map<const Triangles>(corners_.data(), 3, static_cast<Index>(corners_.size() / 3));
    return mesh;
  }

  LineReader reader_;
  std::vector<double> positions_, normals_, colors_;
  std::vector<std::int32_t> corners_, ends_;
  Index faces_ = 0, lines_ = 0;
  std::string element_;  // being read
  bool normals_follow_vertices_ = true;
};

constexpr unsigned pause_after = 1U << 12;  // rows

void append_row(std::string& out, std::string_view keyword, const Point<3>& p) {
  out += keyword;
  for (int axis = 0; axis < 3; ++axis) {
    out += ' ';
    append_number(out, p(axis));
  }
}

}  // namespace

Mesh parse_obj(std::string_view text, const std::string& name) {
  return ObjParser(text, name).parse();
}

Polylines parse_obj_polylines(std::string_view text, const std::string& name) {
  return ObjParser(text, name).parse_polylines();
}

bool is_obj_of_polylines(std::string_view text) {
  bool lines = false;
  for (LineReader reader(text, "", '#'); reader.next();) {
    std::string_view rest = reader.line();
    const std::string_view keyword = take_word(rest);
    if (keyword == "f") return false;
    lines = lines || keyword == "l";
  }
  return lines;
}

std::string format_obj(const Mesh& mesh) {
  const bool has_normals = mesh.normals.cols() == mesh.vertices.cols();
  const ColorColumns colors = find_colors(mesh.properties);
  std::string out;
  InterruptionPoint pause(pause_after);
  for (Index i = 0; i < mesh.vertices.cols(); ++i) {
    pause();
    append_row(out, "v", mesh.vertices.col(i));
    if (colors.complete()) append_row(out, "", colors.unit_rgb(i));
    out += '\n';
  }
  for (Index i = 0; i < mesh.vertices.cols() && has_normals; ++i) {
    pause();
    append_row(out, "vn", mesh.normals.col(i));
    out += '\n';
  }
  for (Index t = 0; t < mesh.triangles.cols(); ++t) {
    pause();
    out += 'f';
    for (int corner = 0; corner < 3; ++corner) {
      const std::string index = std::to_string(mesh.triangles(corner, t) + 1);
      out += ' ' + index;
      if (has_normals) out += "//" + index;
    }
    out += '\n';
  }
  return out;
}

}  // namespace csrbf
