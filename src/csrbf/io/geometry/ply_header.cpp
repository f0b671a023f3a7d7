#include "csrbf/io/geometry/ply_header.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/geometry/properties.hpp"

namespace csrbf {
namespace {

SampleType read_type(const LineReader& reader, std::string_view& rest) {
  const std::string_view word = take_word(rest);
  const auto type = ply_type(word);
  if (!type) reader.fail("unknown type " + in_quotes(word) + " in the header");
  return *type;
}

PlyEncoding read_encoding(const LineReader& reader, std::string_view rest) {
  const std::string_view word = take_word(rest);
  if (word == "ascii") return PlyEncoding::ascii;
  if (word == "binary_little_endian") return PlyEncoding::little_endian;
  if (word == "binary_big_endian") return PlyEncoding::big_endian;
  reader.fail("unknown format " + in_quotes(word) + "; known are ascii, binary_little_endian and binary_big_endian");
}

PlyElement read_element(const LineReader& reader, std::string_view rest) {
  PlyElement element;
  element.name = take_word(rest);
  const std::string_view word = take_word(rest);
  const std::optional<std::int64_t> count = parse_integer(word);
  if (!count || *count < 0) reader.fail(in_quotes(word) + " is not a number of elements");
  element.count = static_cast<Index>(*count);
  return element;
}

PlyProperty read_property(const LineReader& reader, std::string_view rest) {
  PlyProperty property;
  std::string_view after_list = rest;
  if (take_word(after_list) == "list") {
    rest = after_list;
    property.count_type = read_type(reader, rest);
    if (is_floating(*property.count_type)) reader.fail("the length of a list must be an integer");
  }
  property.type = read_type(reader, rest);
  property.name = take_word(rest);
  if (property.name.empty()) reader.fail("a property without a name");
  return property;
}

void add_property(const LineReader& reader, std::vector<PlyElement>& elements, PlyProperty property) {
  if (elements.empty()) reader.fail("a property before the first element");
  std::vector<PlyProperty>& properties = elements.back().properties;
  const auto same_name = [&](const PlyProperty& other) { return other.name == property.name; };
  if (std::any_of(properties.begin(), properties.end(), same_name))
    reader.fail("property " + in_quotes(property.name) + " is declared twice");
  properties.push_back(std::move(property));
}

// The names of its scalar properties; those of lists stay as they are.
void standardize_vertex(PlyElement& vertex) {
  std::vector<std::string> names;
  for (const PlyProperty& p : vertex.properties) names.push_back(p.count_type ? std::string() : p.name);
  standardize_names(names);
  for (std::size_t i = 0; i < names.size(); ++i)
    if (!names[i].empty()) vertex.properties[i].name = names[i];
}

}  // namespace

std::optional<SampleType> ply_type(std::string_view name) {
  for (const TypeName& known : property_types)
    if (name == known.name || name == sample_name(known.type)) return known.type;
  return std::nullopt;
}

bool PlyElement::has_lists() const {
  return std::any_of(properties.begin(), properties.end(),
                     [](const PlyProperty& p) { return p.count_type.has_value(); });
}

std::size_t PlyElement::smallest_binary_size() const {
  std::size_t size = 0;
  for (const PlyProperty& p : properties) size += sample_size(p.count_type.value_or(p.type));
  return size;
}

PlyHeader parse_ply_header(LineReader& reader) {
  if (!reader.next()) throw IoError(reader.name() + ": the file is empty");
  if (reader.line() != "ply") reader.fail("not a PLY file: the first line must be \"ply\"");
  PlyHeader header;
  bool has_format = false;
  while (reader.next()) {
    std::string_view rest = reader.line();
    const std::string_view keyword = take_word(rest);
    if (keyword == "end_header") {
      if (!has_format) reader.fail("the header has no format line");
      // An element without properties takes no space in the body.
      std::erase_if(header.elements, [](const PlyElement& element) { return element.properties.empty(); });
      for (PlyElement& element : header.elements)
        if (element.name == "vertex") standardize_vertex(element);
      return header;
    }
    if (keyword == "format") {
      header.encoding = read_encoding(reader, rest);
      has_format = true;
    } else if (keyword == "element") {
      header.elements.push_back(read_element(reader, rest));
    } else if (keyword == "property") {
      add_property(reader, header.elements, read_property(reader, rest));
    } else if (keyword != "comment" && keyword != "obj_info") {
      reader.fail("unknown header line " + in_quotes(reader.line()));
    }
  }
  reader.fail("the header has no end_header line");
}

}  // namespace csrbf
