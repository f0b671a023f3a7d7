#include "csrbf/io/images/formats.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/deflate.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/files/text.hpp"
#include "csrbf/io/images/raw_data.hpp"

namespace csrbf {
namespace {

using enum SampleType;
constexpr TypeName type_names[] = {
    {"uint8", uint8},      {"int8", int8},           {"uint16", uint16},    {"int16", int16},
    {"uint32", uint32},    {"int32", int32},         {"uint64", uint64},    {"int64", int64},
    {"float", float32},    {"double", float64},      {"uchar", uint8},      {"ushort", uint16},
    {"short", int16},      {"uint", uint32},         {"int", int32},        {"longlong", int64},
    {"ulonglong", uint64}, {"uint8_t", uint8},       {"int8_t", int8},      {"uint16_t", uint16},
    {"int16_t", int16},    {"uint32_t", uint32},     {"int32_t", int32},    {"int64_t", int64},
    {"uint64_t", uint64},  {"unsigned char", uint8}, {"signed char", int8}, {"unsigned short", uint16},
    {"short int", int16},  {"unsigned int", uint32}, {"signed int", int32},
};

constexpr std::size_t most_nrrd_axes = 5;  // components, three in space and time

struct SpaceName {
  std::string_view name, abbreviation;
  Space space;
  double flip_x;
};

constexpr std::array<SpaceName, 3> space_names{{{"right-anterior-superior", "RAS", Space::right_anterior_superior, 1},
                                                {"left-anterior-superior", "LAS", Space::right_anterior_superior, -1},
                                                {"left-posterior-superior", "LPS", Space::left_posterior_superior, 1}}};

// One axis of a NRRD file; the first is the fastest.
struct NrrdAxis {
  Index size = 0;
  std::string kind;                   // "domain", "vector", "time", ...; empty: not given
  std::optional<Point<3>> direction;  // step in space; none: the axis does not lie in space
  double spacing = 0;                 // 0: not given

  // True when, by its kind, the axis holds the components of one value.
  [[nodiscard]] bool is_components() const {
    return !kind.empty() && kind != "domain" && kind != "space" && kind != "time";
  }
};

struct NrrdHeader {
  SampleType type = SampleType::uint8;
  std::endian order = std::endian::little;
  std::vector<NrrdAxis> axes;
  Space space = Space::unknown;
  int space_dimension = 0;
  double flip_x = 1;  // converts x of the file to that of `space`
  Point<3> origin = Point<3>::Zero();
  RawData data;
};

// Reads the header up to the blank line that ends it.
class NrrdHeaderParser {
 public:
  NrrdHeaderParser(std::string_view bytes, const std::string& name) : reader_(bytes, name), bytes_(bytes) {}

  NrrdHeader parse() {
    if (!bytes_.starts_with("NRRD000") || !reader_.next())
      throw IoError(reader_.name() + ": not a NRRD file: it must begin with NRRD000 and the version");
    const std::string_view digit = reader_.line().substr(7);
    if (digit.size() != 1 || digit[0] < '1' || digit[0] > '5')
      reader_.fail("written in NRRD version " + in_quotes(digit) + ", this program reads 1 to 5");
    // LineReader would skip the blank line that ends the header.
    while (!at_end_of_header()) {
      if (!reader_.next()) break;
      read_line();
    }
    const auto missing = [&](bool lacks, const char* field) {
      if (lacks) throw IoError(reader_.name() + ": the header has no field " + in_quotes(field));
    };
    missing(!has_type_, "type");
    missing(!has_sizes_, "sizes");
    missing(!has_encoding_, "encoding");
    if (!has_end_ && header_.data.file.empty()) throw IoError(reader_.name() + ": the file ends within its header");
    return std::move(header_);
  }

 private:
  bool at_end_of_header() {
    const std::string_view rest = reader_.rest();
    const std::size_t skip = rest.starts_with("\r\n") ? 2 : rest.starts_with('\n') ? 1 : 0;
    if (skip == 0) return false;
    header_.data.begin = bytes_.size() - rest.size() + skip;
    return has_end_ = true;
  }

  void read_line() {
    const std::string_view line = reader_.line();
    if (line.starts_with('#')) return;
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos) reader_.fail("expected \"field: value\", found " + in_quotes(line));
    if (line.substr(colon).starts_with(":=")) return;  // the user's own pairs
    const std::string key = lower_case(line.substr(0, colon));
    const std::string_view value = trimmed(line.substr(colon + 1));
    if (!read_description(key, value)) read_axes(key, value);
  }

  // Fields of the whole image; false when `key` is none of them.
  bool read_description(const std::string& key, std::string_view value) {
    if (key == "type") {
      const auto type = type_named(value, type_names);
      if (!type)
        reader_.fail("samples of type " + in_quotes(value) +
                     " are not supported; int8 to uint64, float and double are");
      header_.type = *type;
      has_type_ = true;
    } else if (key == "encoding") {
      read_encoding(value);
    } else if (key == "endian") {
      if (value != "little" && value != "big") reader_.fail(in_quotes(value) + " is neither little nor big");
      header_.order = value == "big" ? std::endian::big : std::endian::little;
    } else if (key == "space") {
      read_space(value);
    } else if (key == "space dimension") {
      header_.space_dimension = static_cast<int>(reader_.integer(value, 1, 3));
    } else if (key == "space origin") {
      header_.origin = vector(value).value_or(Point<3>::Zero());
    } else if (key == "data file" || key == "datafile") {
      if (value.starts_with("LIST") || value.find('%') != std::string_view::npos || value.empty())
        reader_.fail("images in several files are not supported, found " + in_quotes(value));
      header_.data.file = value;
    } else if (key == "line skip" || key == "lineskip") {
      header_.data.skip_lines = reader_.integer(value, 0, std::numeric_limits<std::int64_t>::max());
    } else if (key == "byte skip" || key == "byteskip") {
      header_.data.skip_bytes = reader_.integer(value, -1, std::numeric_limits<std::int64_t>::max());
    } else {
      return false;
    }
    return true;
  }

  // Fields with one item per axis; unknown ones are ignored.
  void read_axes(const std::string& key, std::string_view value) {
    if (key == "dimension") {
      header_.axes.resize(reader_.integer(value, 1, most_nrrd_axes));
      return;
    }
    if (key != "sizes" && key != "spacings" && key != "kinds" && key != "space directions") return;
    if (header_.axes.empty()) reader_.fail("the field \"dimension\" must come before this one");
    for (NrrdAxis& axis : header_.axes) {
      std::string_view word = key == "space directions" ? take_vector(value) : take_word(value);
      if (word.empty()) reader_.fail("expected one item for each of " + std::to_string(header_.axes.size()) + " axes");
      if (key == "sizes") axis.size = reader_.integer(word, 1, index_limit(std::int64_t{1} << 40));
      if (key == "kinds" && word != "???" && word != "none") axis.kind = word;
      if (key == "space directions") axis.direction = vector(word);
      if (key == "spacings") {
        const double spacing = reader_.number(word);
        axis.spacing = std::isfinite(spacing) ? std::abs(spacing) : 0;
      }
    }
    if (!trimmed(value).empty()) reader_.fail("more items than axes: " + in_quotes(trimmed(value)));
    has_sizes_ = has_sizes_ || key == "sizes";
  }

  void read_encoding(std::string_view value) {
    using Encoding = RawData::Encoding;
    if (value == "raw")
      header_.data.encoding = Encoding::raw;
    else if (value == "gzip" || value == "gz")
      header_.data.encoding = Encoding::deflate;
    else if (value == "ascii" || value == "text" || value == "txt")
      header_.data.encoding = Encoding::ascii;
    else
      reader_.fail("encoding " + in_quotes(value) + " is not supported; raw, gzip and ascii are");
    has_encoding_ = true;
  }

  void read_space(std::string_view value) {
    header_.space_dimension = 3;
    if (value.ends_with("-time") || value.ends_with("T"))
      reader_.fail("a space with time, " + in_quotes(value) + ", is not supported");
    for (const SpaceName& known : space_names)
      if (value == known.name || value == known.abbreviation) {
        header_.space = known.space;
        header_.flip_x = known.flip_x;
      }
  }

  // "(1,0,0)" or "none".
  std::string_view take_vector(std::string_view& rest) {
    rest = trimmed(rest);
    if (!rest.starts_with('(')) return take_word(rest);
    const std::size_t end = rest.find(')');
    if (end == std::string_view::npos) reader_.fail("a vector has no closing parenthesis");
    const std::string_view word = rest.substr(0, end + 1);
    rest.remove_prefix(end + 1);
    return word;
  }

  std::optional<Point<3>> vector(std::string_view word) {
    if (word == "none") return std::nullopt;
    if (!word.starts_with('(') || !word.ends_with(')')) reader_.fail(in_quotes(word) + " is not a vector");
    std::string_view list = word.substr(1, word.size() - 2);
    Point<3> v = Point<3>::Zero();
    int found = 0;
    while (!list.empty()) {
      const std::size_t comma = std::min(list.find(','), list.size());
      const auto number = parse_number(trimmed(list.substr(0, comma)));
      if (!number) reader_.fail(in_quotes(word) + " is not a vector of numbers");
      if (found < 3) v(found) = *number;
      ++found;
      list.remove_prefix(std::min(list.size(), comma + 1));
    }
    const int expected = header_.space_dimension;
    if (found > 3 || (expected > 0 && found != expected))
      reader_.fail(in_quotes(word) + " must have " + std::to_string(expected > 0 ? expected : 3) + " numbers");
    return v;
  }

  LineReader reader_;
  std::string_view bytes_;
  bool has_type_ = false, has_sizes_ = false, has_encoding_ = false, has_end_ = false;
  NrrdHeader header_;
};

// Removes the axes of components from the front and of time from the back; the rest lie in space.
void set_nrrd_shape(std::vector<NrrdAxis> axes, const NrrdHeader& header, VolumeLayout& layout,
                    const std::string& name) {
  const bool placed = std::any_of(axes.begin(), axes.end(), [](const NrrdAxis& a) { return a.direction.has_value(); });
  const auto in_space = [&](const NrrdAxis& axis) {
    return !axis.is_components() && axis.kind != "time" && (!placed || axis.direction);
  };
  if (!in_space(axes.front()) && axes.front().kind != "time") {
    layout.components = axes.front().size;
    axes.erase(axes.begin());
  }
  if (axes.size() > 1 && (!in_space(axes.back()) || axes.size() == 4)) {
    layout.frames = axes.back().size;
    if (axes.back().spacing > 0) layout.time_step = axes.back().spacing;
    axes.pop_back();
  }
  if (axes.empty() || axes.size() > 3 || !std::all_of(axes.begin(), axes.end(), in_space))
    throw IoError(name +
                  ": the kinds of the axes are not supported; they must be components, up to three in space, time");
  Grid& grid = layout.grid;
  grid.axes = static_cast<int>(axes.size());
  Eigen::Matrix3d linear = Eigen::Matrix3d::Identity();
  for (Index i = 0; i < grid.axes; ++i) {
    grid.size[i] = axes[i].size;
    if (axes[i].direction)
      linear.col(i) = *axes[i].direction;
    else if (axes[i].spacing > 0)
      linear(i, i) = axes[i].spacing;
  }
  // A slice in space does not define its normal.
  if (placed && grid.axes == 2 && header.space_dimension == 3) linear.col(2).setZero();
  grid.origin = header.origin;
  grid.space = header.space;
  linear.row(0) *= header.flip_x;
  grid.origin(0) *= header.flip_x;
  set_axes(grid, linear, name);
}

}  // namespace

RawVolume parse_nrrd(std::string bytes, const std::string& path) {
  const NrrdHeader header = NrrdHeaderParser(bytes, display_name(path)).parse();
  RawVolume raw;
  raw.layout.type = header.type;
  raw.order = header.order;
  set_nrrd_shape(header.axes, header, raw.layout, display_name(path));
  load_raw_data(raw, header.data, std::move(bytes), path);
  return raw;
}

FileParts format_nrrd(const VolumeLayout& layout, const std::string& samples) {
  const Grid& grid = layout.grid;
  const int space_axes = grid.space == Space::unknown ? grid.axes : 3;
  std::string sizes, directions, kinds, spacings;
  const auto add_axis = [&](Index size, const std::string& direction, std::string_view kind, double spacing) {
    sizes += " " + std::to_string(size);
    directions += " " + direction;
    kinds += " " + std::string(kind);
    spacings += ' ';
    append_number(spacings, spacing);
  };
  const auto vector = [&](const Point<3>& v) {
    std::string text = "(";
    for (int i = 0; i < space_axes; ++i) {
      append_number(text, v(i));
      text += i + 1 < space_axes ? "," : ")";
    }
    return text;
  };
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  if (layout.components > 1)
    add_axis(layout.components, "none", layout.components == 3 ? "3-vector" : "vector", unknown);
  for (int axis = 0; axis < grid.axes; ++axis)
    add_axis(grid.size[axis], vector(grid.direction.col(axis) * grid.spacing(axis)), "domain", unknown);
  if (layout.frames > 1) add_axis(layout.frames, "none", "time", layout.time_step);
  const int axes = grid.axes + (layout.components > 1 ? 1 : 0) + (layout.frames > 1 ? 1 : 0);
  std::string head = "NRRD0005\ntype: " + std::string(name_of(layout.type, type_names)) +
                     "\ndimension: " + std::to_string(axes) + "\n";
  if (grid.space == Space::unknown) {
    head += "space dimension: ";
    head += std::to_string(space_axes);
  } else {
    head += "space: ";
    head += grid.space == Space::left_posterior_superior ? "left-posterior-superior" : "right-anterior-superior";
  }
  head += "\nsizes:" + sizes + "\nspace directions:" + directions + "\nkinds:" + kinds + "\n";
  if (layout.frames > 1 && layout.time_step != 1) head += "spacings:" + spacings + "\n";
  head += "endian: little\nencoding: gzip\nspace origin: " + vector(grid.origin) + "\n\n";
  return {std::move(head), deflate_bytes({samples}, DeflateFormat::gzip)};
}

}  // namespace csrbf
