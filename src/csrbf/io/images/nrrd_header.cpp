#include "csrbf/io/images/nrrd_header.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/text.hpp"

#include <algorithm>

namespace csrbf {
namespace {

struct TypeName {
  std::string_view name;
  SampleType type;
};

// The first name of a type is the one we write.
constexpr std::array<TypeName, 31> type_names{{{"uint8", SampleType::uint8},
                                               {"int8", SampleType::int8},
                                               {"uint16", SampleType::uint16},
                                               {"int16", SampleType::int16},
                                               {"uint32", SampleType::uint32},
                                               {"int32", SampleType::int32},
                                               {"uint64", SampleType::uint64},
                                               {"int64", SampleType::int64},
                                               {"float", SampleType::float32},
                                               {"double", SampleType::float64},
                                               {"uchar", SampleType::uint8},
                                               {"unsigned char", SampleType::uint8},
                                               {"uint8_t", SampleType::uint8},
                                               {"signed char", SampleType::int8},
                                               {"int8_t", SampleType::int8},
                                               {"ushort", SampleType::uint16},
                                               {"unsigned short", SampleType::uint16},
                                               {"uint16_t", SampleType::uint16},
                                               {"short", SampleType::int16},
                                               {"short int", SampleType::int16},
                                               {"int16_t", SampleType::int16},
                                               {"uint", SampleType::uint32},
                                               {"unsigned int", SampleType::uint32},
                                               {"uint32_t", SampleType::uint32},
                                               {"int", SampleType::int32},
                                               {"signed int", SampleType::int32},
                                               {"int32_t", SampleType::int32},
                                               {"longlong", SampleType::int64},
                                               {"int64_t", SampleType::int64},
                                               {"ulonglong", SampleType::uint64},
                                               {"uint64_t", SampleType::uint64}}};

constexpr std::size_t most_axes = 5;  // components, three in space and time

struct SpaceName {
  std::string_view name, abbreviation;
  Space space;
  double flip_x;
};

constexpr std::array<SpaceName, 3> space_names{{{"right-anterior-superior", "RAS", Space::right_anterior_superior, 1},
                                                {"left-anterior-superior", "LAS", Space::right_anterior_superior, -1},
                                                {"left-posterior-superior", "LPS", Space::left_posterior_superior, 1}}};

class HeaderParser {
 public:
  HeaderParser(std::string_view bytes, const std::string& name) : reader_(bytes, name), bytes_(bytes) {}

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
    std::string key(line.substr(0, colon));
    std::transform(key.begin(), key.end(), key.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    const std::string_view value = trimmed(line.substr(colon + 1));
    if (!read_description(key, value)) read_axes(key, value);
  }

  // Fields of the whole image; false when `key` is none of them.
  bool read_description(const std::string& key, std::string_view value) {
    if (key == "type") {
      const auto* found =
          std::find_if(type_names.begin(), type_names.end(), [&](const TypeName& t) { return t.name == value; });
      if (found == type_names.end())
        reader_.fail("samples of type " + in_quotes(value) +
                     " are not supported; int8 to uint64, float and double are");
      header_.type = found->type;
      has_type_ = true;
    } else if (key == "encoding") {
      read_encoding(value);
    } else if (key == "endian") {
      if (value != "little" && value != "big") reader_.fail(in_quotes(value) + " is neither little nor big");
      header_.order = value == "big" ? std::endian::big : std::endian::little;
    } else if (key == "space") {
      read_space(value);
    } else if (key == "space dimension") {
      header_.space_dimension = static_cast<int>(integer(value, 1, 3));
    } else if (key == "space origin") {
      header_.origin = vector(value).value_or(Point<3>::Zero());
    } else if (key == "data file" || key == "datafile") {
      if (value.starts_with("LIST") || value.find('%') != std::string_view::npos || value.empty())
        reader_.fail("images in several files are not supported, found " + in_quotes(value));
      header_.data.file = value;
    } else if (key == "line skip" || key == "lineskip") {
      header_.data.skip_lines = integer(value, 0, std::numeric_limits<std::int64_t>::max());
    } else if (key == "byte skip" || key == "byteskip") {
      header_.data.skip_bytes = integer(value, -1, std::numeric_limits<std::int64_t>::max());
    } else {
      return false;
    }
    return true;
  }

  // Fields with one item per axis; unknown ones are ignored.
  void read_axes(const std::string& key, std::string_view value) {
    if (key == "dimension") {
      header_.axes.resize(integer(value, 1, most_axes));
      return;
    }
    if (key != "sizes" && key != "spacings" && key != "kinds" && key != "space directions") return;
    if (header_.axes.empty()) reader_.fail("the field \"dimension\" must come before this one");
    for (NrrdAxis& axis : header_.axes) {
      std::string_view word = key == "space directions" ? take_vector(value) : take_word(value);
      if (word.empty()) reader_.fail("expected one item for each of " + std::to_string(header_.axes.size()) + " axes");
      if (key == "sizes") axis.size = static_cast<Index>(integer(word, 1, std::int64_t{1} << 40));
      if (key == "kinds" && word != "???" && word != "none") axis.kind = word;
      if (key == "space directions") axis.direction = vector(word);
      if (key == "spacings") {
        const auto spacing = parse_number(word);
        if (!spacing) reader_.fail(in_quotes(word) + " is not a number");
        axis.spacing = std::isfinite(*spacing) ? std::abs(*spacing) : 0;
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

  std::int64_t integer(std::string_view value, std::int64_t lo, std::int64_t hi) {
    const auto number = parse_integer(value);
    if (!number || *number < lo || *number > hi)
      reader_.fail(in_quotes(value) + " is not a whole number from " + std::to_string(lo) + " to " +
                   std::to_string(hi));
    return *number;
  }

  LineReader reader_;
  std::string_view bytes_;
  bool has_type_ = false, has_sizes_ = false, has_encoding_ = false, has_end_ = false;
  NrrdHeader header_;
};

}  // namespace

bool NrrdAxis::is_components() const {
  return !kind.empty() && kind != "domain" && kind != "space" && kind != "time";
}

NrrdHeader parse_nrrd_header(std::string_view bytes, const std::string& name) {
  return HeaderParser(bytes, name).parse();
}

std::string_view nrrd_type_name(SampleType type) {
  return std::find_if(type_names.begin(), type_names.end(), [&](const TypeName& t) { return t.type == type; })->name;
}

}  // namespace csrbf
