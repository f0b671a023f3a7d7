#include "csrbf/core/error.hpp"
#include "csrbf/io/files/bytes.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/files/text.hpp"
#include "csrbf/io/geometry/formats.hpp"
#include "csrbf/io/geometry/properties.hpp"

namespace csrbf {
namespace {

constexpr Index most_fields = 1024;

struct Field {
  std::string name;
  SampleType type = SampleType::float32;
  std::size_t size = 4;
  Index count = 1;
  std::size_t offset = 0;  // in the record of a point
};

bool is_packed_color(const Field& field) {
  return (field.name == "rgb" || field.name == "rgba") && field.size == 4;
}

struct PcdHeader {
  std::vector<Field> fields;
  Index points = 0;
  std::size_t stride = 0;
  std::string data;  // ascii, binary or binary_compressed
};

std::vector<std::string_view> words_of(std::string_view text) {
  std::vector<std::string_view> words;
  for (std::string_view word = take_word(text); !word.empty(); word = take_word(text)) words.push_back(word);
  return words;
}

SampleType type_of(const LineReader& reader, std::string_view kind, std::size_t size) {
  const TypeName known[] = {{"F4", SampleType::float32}, {"F8", SampleType::float64}, {"I1", SampleType::int8},
                            {"I2", SampleType::int16},   {"I4", SampleType::int32},   {"I8", SampleType::int64},
                            {"U1", SampleType::uint8},   {"U2", SampleType::uint16},  {"U4", SampleType::uint32},
                            {"U8", SampleType::uint64}};
  const auto type = type_named(std::string(kind) + std::to_string(size), known);
  if (!type) reader.fail("fields of TYPE " + in_quotes(kind) + " and SIZE " + std::to_string(size) + " are not known");
  return *type;
}

// What the lines before the data say; they are known by their first words.
PcdHeader read_header(LineReader& reader) {
  constexpr std::int64_t most_points = index_limit(std::int64_t{1} << 40);
  PcdHeader header;
  std::vector<std::string_view> types;
  std::int64_t width = 0, height = 1;
  while (header.data.empty()) {
    if (!reader.next()) reader.fail("the header has no line DATA");
    std::string_view rest = reader.line();
    const std::string_view keyword = take_word(rest);
    const std::vector<std::string_view> words = words_of(rest);
    const auto one_per_field = [&] {
      if (words.size() != header.fields.size())
        reader.fail(std::string(keyword) + " needs one entry for each of the " + std::to_string(header.fields.size()) +
                    " FIELDS");
    };
    const auto whole = [&](std::int64_t least) {
      return reader.integer(words.empty() ? std::string_view() : words[0], least, most_points);
    };
    if (keyword == "FIELDS") {
      if (std::ssize(words) > most_fields) reader.fail("more than 1024 fields");
      for (const std::string_view name : words) header.fields.emplace_back().name = name;
    } else if (keyword == "SIZE") {
      one_per_field();
      for (std::size_t i = 0; i < words.size(); ++i)
        header.fields[i].size = static_cast<std::size_t>(reader.integer(words[i], 1, 8));
    } else if (keyword == "TYPE") {
      one_per_field();
      types = words;
    } else if (keyword == "COUNT") {
      one_per_field();
      for (std::size_t i = 0; i < words.size(); ++i) header.fields[i].count = reader.integer(words[i], 1, 1 << 20);
    } else if (keyword == "WIDTH") {
      width = whole(0);
    } else if (keyword == "HEIGHT") {
      height = whole(0);
    } else if (keyword == "POINTS") {
      header.points = whole(0);
    } else if (keyword == "DATA") {
      header.data = words.empty() ? "" : lower_case(words[0]);
      if (!is_listed(header.data, "ascii binary binary_compressed"))
        reader.fail("DATA is ascii, binary or binary_compressed, not " + in_quotes(rest));
    } else if (keyword != "VERSION" && keyword != "VIEWPOINT") {
      reader.fail(in_quotes(keyword) + " does not belong to the header of a PCD file");
    }
  }
  if (header.fields.empty()) reader.fail("the header has no line FIELDS");
  if (types.size() != header.fields.size()) reader.fail("the header has no line TYPE after FIELDS");
  for (std::size_t i = 0; i < types.size(); ++i) {
    Field& field = header.fields[i];
    field.type = type_of(reader, types[i], field.size);
    // As a float, a packed colour may be a NaN, which loses bits when it is converted.
    if (is_packed_color(field) && header.data != "ascii") field.type = SampleType::uint32;
    field.offset = header.stride;
    header.stride += field.size * static_cast<std::size_t>(field.count);
  }
  if (header.points == 0 && height > 0 && width <= most_points / height) header.points = width * height;
  return header;
}

// LZF, the format of Marc Lehmann's LibLZF: runs of bytes as they are, and copies of earlier ones.
std::string expand_lzf(std::string_view in, std::size_t size, const std::string& name) {
  const auto damaged = [&] { throw IoError(name + ": the compressed data are damaged"); };
  std::string out;
  out.reserve(size);
  std::size_t i = 0;
  const auto next = [&] {
    if (i >= in.size()) damaged();
    return static_cast<std::size_t>(static_cast<unsigned char>(in[i++]));
  };
  constexpr std::size_t longest_run = 32, long_copy = 7;
  while (i < in.size()) {
    const std::size_t control = next();
    if (control < longest_run) {
      if (in.size() - i < control + 1 || size - out.size() < control + 1) damaged();
      out.append(in.substr(i, control + 1));
      i += control + 1;
      continue;
    }
    std::size_t length = control >> 5;
    if (length == long_copy) length += next();
    length += 2;
    const std::size_t distance = ((control & 31) << 8) + next() + 1;
    if (distance > out.size() || size - out.size() < length) damaged();
    for (std::size_t k = 0; k < length; ++k) out.push_back(out[out.size() - distance]);
  }
  if (out.size() != size) damaged();
  return out;
}

double load(const char* bytes, SampleType type) {
  return with_sample_type(type, [&](auto sample) { return static_cast<double>(load_scalar<decltype(sample)>(bytes)); });
}

// One row per field of a single number, one column per point; NaN in the rows of others.
Eigen::MatrixXd read_binary(const PcdHeader& header, std::string_view bytes, const std::string& name) {
  std::string expanded;
  const bool by_field = header.data == "binary_compressed";
  if (by_field) {
    constexpr std::size_t sizes = 8;
    if (bytes.size() < sizes) throw IoError(name + ": the file is truncated: the sizes of its data are missing");
    const std::size_t packed = load_scalar<std::uint32_t>(bytes.data());
    const std::size_t full = load_scalar<std::uint32_t>(bytes.data() + 4);
    constexpr std::size_t best_ratio = 264;  // of LZF: a copy of 264 bytes takes three
    if (packed > bytes.size() - sizes || full > best_ratio * packed)
      throw IoError(name + ": the file is truncated: it holds " + std::to_string(bytes.size() - sizes) + " of " +
                    std::to_string(packed) + " bytes of compressed data");
    expanded = expand_lzf(bytes.substr(sizes, packed), full, name);
    bytes = expanded;
  }
  const auto points = static_cast<std::size_t>(header.points);
  if (header.stride == 0 || bytes.size() / header.stride < points)
    throw IoError(name + ": the file is truncated: it has room for " +
                  std::to_string(bytes.size() / std::max<std::size_t>(1, header.stride)) + " of its " +
                  std::to_string(points) + " points");
  Eigen::MatrixXd values(std::ssize(header.fields), header.points);
  for (std::size_t f = 0; f < header.fields.size(); ++f) {
    const Field& field = header.fields[f];
    const std::size_t step = by_field ? field.size * static_cast<std::size_t>(field.count) : header.stride;
    const char* first = bytes.data() + (by_field ? points * field.offset : field.offset);
    for (std::size_t i = 0; i < points; ++i)
      values(static_cast<Index>(f), static_cast<Index>(i)) = load(first + i * step, field.type);
  }
  return values;
}

Eigen::MatrixXd read_text(const PcdHeader& header, LineReader& reader) {
  Index columns = 0;
  for (const Field& field : header.fields) columns += field.count;
  if (!reader.can_hold(header.points, columns)) reader.fail("the file is truncated: there are fewer rows than POINTS");
  Eigen::MatrixXd values(std::ssize(header.fields), header.points);
  for (Index i = 0; i < header.points; ++i) {
    if (!reader.next()) reader.fail("the file is truncated: row " + std::to_string(i + 1) + " is missing");
    std::string_view rest = reader.line();
    for (Index f = 0; f < values.rows(); ++f)
      for (Index k = 0; k < header.fields[static_cast<std::size_t>(f)].count; ++k) {
        const std::string_view word = take_word(rest);
        if (word.empty()) reader.fail("the row has fewer than " + std::to_string(columns) + " numbers");
        values(f, i) = reader.number(word);
      }
  }
  return values;
}

// Properties have no integers of 64 bits.
std::string property_type(SampleType type) {
  const std::string_view known = name_of(type, property_types);
  return known.empty() ? "double" : std::string(known);
}

// PCL packs colours into the bits of a float or an integer.
void add_packed_colors(const Eigen::MatrixXd& values, Index row, SampleType type, std::vector<Property>& properties) {
  Eigen::MatrixXd parts(3, values.cols());
  for (Index i = 0; i < values.cols(); ++i) {
    const double value = values(row, i);
    const auto packed = type == SampleType::float32 ? bit_cast<std::uint32_t>(static_cast<float>(value))
                                                    : narrow_scalar<std::uint32_t>(value);
    for (Index c = 0; c < 3; ++c) parts(c, i) = (packed >> (16 - 8 * c)) & 0xFFU;
  }
  const char* names[] = {"red", "green", "blue"};
  for (Index c = 0; c < 3; ++c) properties.push_back({names[c], "uchar", parts.row(c).transpose()});
}

}  // namespace

PointCloud parse_pcd(std::string_view bytes, const std::string& name) {
  LineReader reader(bytes, name, '#');
  const PcdHeader header = read_header(reader);
  const Eigen::MatrixXd values =
      header.data == "ascii" ? read_text(header, reader) : read_binary(header, reader.rest(), name);

  const auto row_of = [&](std::string_view wanted) {
    const auto is_wanted = [&](const Field& field) { return field.name == wanted && field.count == 1; };
    const auto found = std::find_if(header.fields.begin(), header.fields.end(), is_wanted);
    return found == header.fields.end() ? Index{-1} : static_cast<Index>(found - header.fields.begin());
  };
  const auto take_three = [&](const std::array<const char*, 3>& names, Points<3>& to) {
    const std::array<Index, 3> rows = {row_of(names[0]), row_of(names[1]), row_of(names[2])};
    if (std::count(rows.begin(), rows.end(), Index{-1}) > 0) return false;
    to = values(rows, Eigen::all);
    return true;
  };
  PointCloud cloud;
  if (!take_three({"x", "y", "z"}, cloud.points)) throw IoError(name + ": the points have no fields x, y and z");
  const bool has_normals = take_three({"normal_x", "normal_y", "normal_z"}, cloud.normals);
  for (Index f = 0; f < values.rows(); ++f) {
    const Field& field = header.fields[static_cast<std::size_t>(f)];
    const bool taken = is_listed(field.name, has_normals ? "x y z normal_x normal_y normal_z _" : "x y z _");
    if (taken || field.count != 1) continue;
    if (is_packed_color(field))
      add_packed_colors(values, f, field.type, cloud.properties);
    else
      cloud.properties.push_back({field.name, property_type(field.type), values.row(f).transpose()});
  }
  return cloud;
}

}  // namespace csrbf
