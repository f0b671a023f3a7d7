#include "csrbf/io/geometry/formats.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/interruption.hpp"
#include "csrbf/io/files/text.hpp"
#include "csrbf/io/geometry/properties.hpp"

namespace csrbf {
namespace {

// What follows the coordinates of a vertex on its line: normal, colour (3 or 4 components), texture coordinates.
struct Layout {
  bool normals = false;
  bool colors = false;
  bool texture = false;
};

class OffParser {
 public:
  OffParser(std::string_view text, const std::string& name) : reader_(text, name, '#') {}

  Mesh parse() {
    if (!reader_.next()) throw IoError(reader_.name() + ": the file is empty");
    read_head();
    read_vertices();
    read_faces();
    return std::move(mesh_);
  }

 private:
  // Keyword and counts, on one or two lines.
  void read_head() {
    std::string_view rest = reader_.line();
    const std::size_t keyword = rest.find("OFF");
    const std::string_view prefix = rest.substr(0, std::min(keyword, rest.size()));
    if (keyword == std::string_view::npos || prefix.find_first_not_of("STCN") != std::string_view::npos)
      reader_.fail("not an OFF file of 3D points: the first line must begin with OFF, COFF, NOFF or CNOFF");
    layout_ = {prefix.find('N') != std::string_view::npos, prefix.find('C') != std::string_view::npos,
               prefix.find("ST") != std::string_view::npos};
    rest.remove_prefix(keyword + 3);
    if (count_words(rest) == 0) {
      if (!reader_.next()) reader_.fail("the file ends before the number of vertices");
      rest = reader_.line();
    }
    vertices_ = read_count(rest, "vertices");
    faces_ = read_count(rest, "faces");
    if (!reader_.can_hold(vertices_, 3) || !reader_.can_hold(faces_, 1))
      reader_.fail("the counts promise more than the file can hold");
    if (vertices_ == 0) throw IoError(reader_.name() + ": the file has no vertices");
  }

  Index read_count(std::string_view& rest, const char* what) const {
    const std::string_view word = take_word(rest);
    const auto count = parse_integer(word);
    if (!count || *count < 0) reader_.fail(in_quotes(word) + " is not a number of " + what);
    if (*count > std::numeric_limits<std::int32_t>::max()) reader_.fail("more than 2^31 - 1 " + std::string(what));
    return static_cast<Index>(*count);
  }

  void next_line(const char* what, Index done, Index all) {
    if (!reader_.next())
      reader_.fail("the file ends after " + std::to_string(done) + " of " + std::to_string(all) + " " + what);
  }

  void read_vertices() {
    const int color_at = layout_.normals ? 6 : 3;
    const int fewest = color_at + (layout_.colors ? 3 : 0) + (layout_.texture ? 2 : 0);
    const int most = fewest + (layout_.colors ? 1 : 0);
    mesh_.vertices.resize(3, vertices_);
    mesh_.normals.resize(3, layout_.normals ? vertices_ : 0);
    Eigen::MatrixXd colors(3, layout_.colors ? vertices_ : 0);
    for (Index i = 0; i < vertices_; ++i) {
      next_line("vertices", i, vertices_);
      std::array<double, 12> row{};
      const int found = read_row(row);
      if (found < fewest || found > most)
        reader_.fail("expected " + std::to_string(fewest) + (fewest == 3 ? " coordinates" : " numbers") + ", found " +
                     std::to_string(found));
      mesh_.vertices.col(i) << row[0], row[1], row[2];
      if (layout_.normals) mesh_.normals.col(i) << row[3], row[4], row[5];
      if (layout_.colors) colors.col(i) << row[color_at], row[color_at + 1], row[color_at + 2];
    }
    if (layout_.colors) add_colors(colors, mesh_.properties);
  }

  int read_row(std::array<double, 12>& row) const {
    std::string_view rest = reader_.line();
    std::size_t found = 0;
    for (std::string_view word = take_word(rest); !word.empty(); word = take_word(rest), ++found) {
      const double value = reader_.number(word);
      if (found < row.size()) row[found] = value;
    }
    return static_cast<int>(found);
  }

  void read_faces() {
    std::vector<std::int32_t> corners;
    corners.reserve(3 * faces_);
    for (Index face = 0; face < faces_; ++face) {
      next_line("faces", face, faces_);
      std::string_view rest = reader_.line();
      const auto size = parse_integer(take_word(rest));
      if (!size || *size < 0)
        reader_.fail("face " + std::to_string(face) + " does not begin with its number of corners");
      std::int32_t first = 0;
      std::int32_t previous = 0;
      for (std::int64_t corner = 0; corner < *size; ++corner) {
        const std::int32_t index = read_index(take_word(rest), face);
        if (corner == 0) first = index;
        if (corner >= 2) corners.insert(corners.end(), {first, previous, index});
        previous = index;
      }
    }
    mesh_.triangles = Eigen::Map<const Triangles>(corners.data(), 3, static_cast<Index>(corners.size() / 3));
  }

  std::int32_t read_index(std::string_view word, Index face) const {
    const auto index = parse_integer(word);
    if (!index) reader_.fail("face " + std::to_string(face) + ": " + in_quotes(word) + " is not a vertex index");
    if (*index < 0 || *index >= vertices_)
      reader_.fail("face " + std::to_string(face) + ": vertex index " + std::to_string(*index) + " is not one of the " +
                   std::to_string(vertices_) + " vertices");
    return static_cast<std::int32_t>(*index);
  }

  LineReader reader_;
  Layout layout_;
  Index vertices_ = 0;
  Index faces_ = 0;
  Mesh mesh_;
};

void append_numbers(std::string& out, const Point<3>& p) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!out.empty() && out.back() != '\n') out += ' ';
    append_number(out, p(axis));
  }
}

}  // namespace

Mesh parse_off(std::string_view text, const std::string& name) {
  return OffParser(text, name).parse();
}

std::string format_off(const Mesh& mesh) {
  const bool has_normals = mesh.normals.cols() > 0 && mesh.normals.cols() == mesh.vertices.cols();
  const ColorColumns colors = find_colors(mesh.properties);
  std::string out = colors.complete() ? "C" : "";
  out += has_normals ? "NOFF\n" : "OFF\n";
  out += std::to_string(mesh.vertices.cols()) + " " + std::to_string(mesh.triangles.cols()) + " 0\n";
  InterruptionPoint pause(1U << 12);
  for (Index i = 0; i < mesh.vertices.cols(); ++i) {
    pause();
    append_numbers(out, mesh.vertices.col(i));
    if (has_normals) append_numbers(out, mesh.normals.col(i));
    if (colors.complete()) {
      append_numbers(out, colors.rgb(i).array().round());
      out += " 255";
    }
    out += '\n';
  }
  for (Index t = 0; t < mesh.triangles.cols(); ++t) {
    pause();
    out += '3';
    for (int corner = 0; corner < 3; ++corner) out += ' ' + std::to_string(mesh.triangles(corner, t));
    out += '\n';
  }
  return out;
}

}  // namespace csrbf
