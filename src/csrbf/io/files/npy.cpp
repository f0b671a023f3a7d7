#include "csrbf/io/files/npy.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/text.hpp"

namespace csrbf {
namespace {

constexpr std::string_view magic = "\x93NUMPY";

using enum SampleType;
constexpr TypeName type_codes[] = {
    {"u1", uint8},  {"i1", int8},  {"u2", uint16},  {"i2", int16},   {"u4", uint32}, {"i4", int32},
    {"u8", uint64}, {"i8", int64}, {"f4", float32}, {"f8", float64}, {"b1", uint8},
};

[[noreturn]] void fail(const std::string& name, const std::string& message) {
  throw IoError(name + ": " + message);
}

// The text after 'key': in the dictionary of the header.
std::string_view value_of(std::string_view dictionary, std::string_view key, const std::string& name) {
  const std::size_t found = dictionary.find("'" + std::string(key) + "'");
  const std::size_t colon = found == std::string_view::npos ? found : dictionary.find(':', found);
  if (colon == std::string_view::npos) fail(name, "the .npy header has no entry " + in_quotes(key));
  return trimmed(dictionary.substr(colon + 1));
}

void parse_type(std::string_view text, const std::string& name, NpyHeader& header) {
  const std::size_t end = text.find('\'', 1);
  if (text.empty() || text[0] != '\'' || end == std::string_view::npos || end < 2)
    fail(name, "arrays of records are not supported; save a plain array of float64");
  const std::string_view type = text.substr(1, end - 1);
  header.order = type[0] == '>' ? std::endian::big : std::endian::little;
  const auto known = type_named(type.substr(1), type_codes);
  if (!known) fail(name, "elements of type " + in_quotes(type) + " are not supported; save float64");
  header.type = *known;
}

void parse_shape(std::string_view text, const std::string& name, NpyHeader& header) {
  const std::size_t end = text.find(')');
  if (text.empty() || text[0] != '(' || end == std::string_view::npos) fail(name, "the .npy header has no valid shape");
  std::string_view list = text.substr(1, end - 1);
  while (!trimmed(list).empty()) {
    const std::size_t comma = std::min(list.find(','), list.size());
    const auto length = parse_integer(trimmed(list.substr(0, comma)));
    if (!length || *length < 0) fail(name, "the .npy header has no valid shape");
    header.shape.push_back(static_cast<Index>(*length));
    list.remove_prefix(std::min(list.size(), comma + 1));
  }
}

// Number of elements; refuses shapes larger than the data, however large their product.
std::size_t checked_size(const NpyHeader& header, std::size_t data_bytes, const std::string& name) {
  const std::size_t room = data_bytes / sample_size(header.type);
  const auto check = [&](bool fits) {
    if (!fits) fail(name, "the file is truncated: it holds " + std::to_string(room) + " elements");
  };
  std::size_t size = 1;
  for (const Index length : header.shape) {
    check(length == 0 || size <= room / length);
    size *= length;
  }
  check(size <= room);  // without axes there is one element
  return size;
}

// Position in C order of the k-th element in Fortran order.
std::size_t fortran_to_c(std::size_t k, const std::vector<Index>& shape) {
  std::size_t position = 0, stride = 1;
  for (const Index length : shape) stride *= length;
  for (const Index length : shape) {
    stride /= length;
    position += (k % length) * stride;
    k /= length;
  }
  return position;
}

}  // namespace

NpyHeader parse_npy_header(std::string_view& bytes, const std::string& name) {
  if (bytes.empty()) fail(name, "the file is empty");
  if (!bytes.starts_with(magic) || bytes.size() < 12) fail(name, "not a .npy file");
  const int version = bytes[6];
  if (version < 1 || version > 3)
    fail(name, "written in .npy format " + std::to_string(version) + ", this program reads 1 to 3");
  const std::size_t prefix = version == 1 ? 10 : 12;
  const std::size_t length =
      version == 1 ? load_scalar<std::uint16_t>(bytes.data() + 8) : load_scalar<std::uint32_t>(bytes.data() + 8);
  if (length > bytes.size() - prefix) fail(name, "the file ends within its header");
  const std::string_view dictionary = bytes.substr(prefix, length);
  bytes.remove_prefix(prefix + length);
  NpyHeader header;
  parse_type(value_of(dictionary, "descr", name), name, header);
  parse_shape(value_of(dictionary, "shape", name), name, header);
  header.fortran = value_of(dictionary, "fortran_order", name).starts_with("True");
  return header;
}

std::string npy_bytes_in_c_order(const NpyHeader& header, std::string_view data, const std::string& name) {
  const std::size_t size = sample_size(header.type);
  const std::size_t count = checked_size(header, data.size(), name);
  std::string bytes(count * size, '\0');
  for (std::size_t k = 0; k < count; ++k)
    data.copy(bytes.data() + fortran_to_c(k, header.shape) * size, size, k * size);
  return bytes;
}

NpyArray parse_npy(std::string_view bytes, const std::string& name) {
  const NpyHeader header = parse_npy_header(bytes, name);
  NpyArray array;
  array.shape = header.shape;
  array.values.resize(checked_size(header, bytes.size(), name));
  with_sample_type(header.type, [&](auto sample) {
    for (std::size_t k = 0; k < array.values.size(); ++k)
      array.values[header.fortran ? fortran_to_c(k, header.shape) : k] =
          static_cast<double>(load_scalar<decltype(sample)>(bytes.data() + k * sizeof(sample), header.order));
  });
  return array;
}

std::string format_npy_header(SampleType type, const std::vector<Index>& lengths) {
  std::string shape;  // as NumPy writes it: (3, 4), (3,)
  for (const Index length : lengths) shape += (shape.empty() ? "" : ", ") + std::to_string(length);
  if (lengths.size() == 1) shape += ",";
  std::string dictionary = "{'descr': '" + std::string(sample_size(type) == 1 ? "|" : "<") +
                           std::string(name_of(type, type_codes)) + "', 'fortran_order': False, 'shape': (" + shape +
                           "), }";
  constexpr std::size_t prefix = 10;
  constexpr std::size_t alignment = 64;  // of the data, by the format
  dictionary.append(alignment - 1 - (prefix + dictionary.size()) % alignment, ' ');
  dictionary += '\n';
  std::string out(magic);
  out += {'\x01', '\x00'};
  append_scalar(out, static_cast<std::uint16_t>(dictionary.size()));
  return out + dictionary;
}

std::string format_npy(const NpyArray& array) {
  std::string out = format_npy_header(float64, array.shape);
  out.reserve(out.size() + 8 * array.values.size());
  for (const double value : array.values) append_scalar(out, value);
  return out;
}

}  // namespace csrbf
