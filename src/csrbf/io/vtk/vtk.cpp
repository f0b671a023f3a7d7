#include "csrbf/io/vtk/vtk.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/bytes.hpp"
#include "csrbf/io/files/deflate.hpp"
#include "csrbf/io/files/text.hpp"

namespace csrbf {
namespace {

// In the order of SampleType.
constexpr std::array<std::string_view, 10> type_names{"UInt8", "Int8",   "UInt16", "Int16",   "UInt32",
                                                      "Int32", "UInt64", "Int64",  "Float32", "Float64"};

int base64_digit(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  return c == '+' ? 62 : c == '/' ? 63 : -1;
}

// The stream of bytes of an array, raw or in base64.
class ByteSource {
 public:
  ByteSource(std::string_view text, bool is_base64) : text_(text), is_base64_(is_base64) {}

  // An upper bound on the bytes that are left.
  [[nodiscard]] std::size_t left() const { return text_.size() + carry_.size(); }

  // The next bytes; fewer when the text ends earlier.
  std::string read(std::size_t size) {
    std::string out;
    if (!is_base64_) {
      out = text_.substr(0, size);
      text_.remove_prefix(out.size());
      return out;
    }
    out = std::move(carry_);
    out.reserve(std::min(size, left()) + 3);
    while (out.size() < size && read_group(out)) continue;
    carry_ = out.substr(std::min(size, out.size()));
    out.resize(out.size() - carry_.size());
    return out;
  }

 private:
  // Four digits are three bytes; consecutive blocks of base64 are padded separately.
  bool read_group(std::string& out) {
    std::array<int, 4> digits{};
    int found = 0, padding = 0;
    while (found < 4 && !text_.empty()) {
      const char c = text_.front();
      const int digit = base64_digit(c);
      if (digit < 0 && c != '=' && static_cast<unsigned char>(c) > ' ') return false;
      text_.remove_prefix(1);
      if (digit < 0 && c != '=') continue;
      padding += c == '=' ? 1 : 0;
      digits[found++] = std::max(digit, 0);
    }
    if (found < 4) return false;
    const int bits = digits[0] << 18 | digits[1] << 12 | digits[2] << 6 | digits[3];
    for (int i = 0; i < 3 - padding; ++i) out += static_cast<char>(bits >> (16 - 8 * i) & 255);
    return true;
  }

  std::string_view text_;
  bool is_base64_;
  std::string carry_;
};

// The size header of an array, and its bytes.
class BlockReader {
 public:
  BlockReader(ByteSource source, std::size_t header_size, std::endian order, const std::string& name)
      : source_(std::move(source)), header_size_(header_size), order_(order), name_(name) {}

  std::string read_plain(std::size_t expected) {
    const std::size_t size = read_number();
    check_size(size, expected);
    if (size > source_.left()) truncated();
    return checked(source_.read(size), size);
  }

  std::string read_compressed(std::size_t expected) {
    const std::size_t blocks = read_number(), block_size = read_number(), last_size = read_number();
    if (blocks > source_.left() / header_size_ || (blocks > 0 && block_size > expected && last_size == 0)) truncated();
    std::vector<std::size_t> sizes(blocks);
    for (std::size_t& size : sizes) size = read_number();
    constexpr std::size_t largest_ratio = 1100;  // deflate's limit is 1032
    if (expected / largest_ratio > source_.left()) truncated();
    std::string out;
    for (std::size_t i = 0; i < blocks; ++i) {
      if (sizes[i] > source_.left()) truncated();
      const std::string block = checked(source_.read(sizes[i]), sizes[i]);
      const std::size_t size = i + 1 == blocks && last_size > 0 ? last_size : block_size;
      if (size > expected - out.size()) check_size(out.size() + size, expected);
      out += inflate_bytes(block, size, name_);
    }
    check_size(out.size(), expected);
    return out;
  }

 private:
  std::size_t read_number() {
    const std::string bytes = checked(source_.read(header_size_), header_size_);
    return header_size_ == 8 ? static_cast<std::size_t>(load_scalar<std::uint64_t>(bytes.data(), order_))
                             : load_scalar<std::uint32_t>(bytes.data(), order_);
  }

  std::string checked(std::string bytes, std::size_t size) const {
    if (bytes.size() < size) truncated();
    return bytes;
  }

  void check_size(std::size_t size, std::size_t expected) const {
    if (size != expected)
      throw IoError(name_ + ": the data have " + std::to_string(size) + " bytes, " + std::to_string(expected) +
                    " are expected");
  }

  [[noreturn]] void truncated() const { throw IoError(name_ + ": the data are truncated"); }

  ByteSource source_;
  std::size_t header_size_;
  std::endian order_;
  const std::string& name_;
};

std::string name_of_array(const XmlElement& array) {
  const std::string* name = array.attribute("Name");
  return "array " + in_quotes(name == nullptr ? "" : *name);
}

}  // namespace

std::string vtk_bytes(SampleType type, const Eigen::Ref<const Eigen::MatrixXd>& values) {
  return with_sample_type(type, [&](auto sample) {
    using T = decltype(sample);
    std::string bytes(static_cast<std::size_t>(values.size()) * sizeof(T), '\0');
    char* out = bytes.data();
    for (Index column = 0; column < values.cols(); ++column)
      for (Index row = 0; row < values.rows(); ++row, out += sizeof(T))
        store_scalar(out, narrow_scalar<T>(values(row, column)));
    return bytes;
  });
}

std::string VtkWriter::array(VtkArray array) {
  const std::string tag = "<DataArray type=\"" + std::string(type_names[static_cast<std::size_t>(array.type)]) +
                          "\" Name=\"" + xml_escaped(array.name) + "\" NumberOfComponents=\"" +
                          std::to_string(array.components) + "\" format=\"appended\" offset=\"" +
                          std::to_string(data_.size()) + "\"/>\n";
  append_scalar(data_, static_cast<std::uint64_t>(array.bytes.size()));
  data_ += array.bytes;
  return tag;
}

FileParts VtkWriter::file(std::string_view type, const std::string& content) const {
  return {"<?xml version=\"1.0\"?>\n<VTKFile type=\"" + std::string(type) +
              "\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n" + content +
              "<AppendedData encoding=\"raw\">\n_",
          data_ + "\n</AppendedData>\n</VTKFile>\n"};
}

VtkReader::VtkReader(std::string_view bytes, std::string_view type, const std::string& name)
    : name_(name), root_(parse_xml(bytes, "AppendedData", name)) {
  const auto attribute = [](const XmlElement& element, std::string_view key) {
    const std::string* value = element.attribute(key);
    return value == nullptr ? std::string() : *value;
  };
  if (root_.name != "VTKFile") fail("not a VTK file: its XML begins with " + in_quotes(root_.name));
  if (attribute(root_, "type") != type)
    fail("the file holds " + in_quotes(attribute(root_, "type")) + ", expected " + in_quotes(type));
  data_set_ = root_.child(type);
  if (data_set_ == nullptr) fail("the element " + in_quotes(type) + " is missing");
  for (const XmlElement& element : data_set_->children) {
    if (element.name != "Piece") continue;
    if (piece_ != nullptr) fail("files of several pieces are not supported; write the data in one");
    piece_ = &element;
  }
  if (piece_ == nullptr) fail("the file has no piece");
  if (attribute(root_, "byte_order") == "BigEndian") order_ = std::endian::big;
  if (attribute(root_, "header_type") == "UInt64") header_size_ = 8;
  const std::string compressor = attribute(root_, "compressor");
  compressed_ = !compressor.empty();
  if (compressed_ && compressor != "vtkZLibDataCompressor")
    fail("compressor " + in_quotes(compressor) + " is not supported; write the data with zlib or without compression");
  if (const XmlElement* data = root_.child("AppendedData")) {
    appended_is_base64_ = attribute(*data, "encoding") == "base64";
    const std::size_t mark = data->text.find('_');
    if (mark != std::string_view::npos) appended_ = data->text.substr(mark + 1);
  }
}

void VtkReader::fail(const std::string& what) const {
  throw IoError(name_ + ": " + what);
}

Index VtkReader::count(const XmlElement& element, std::string_view attribute) const {
  const std::string* text = element.attribute(attribute);
  if (text == nullptr) return 0;
  constexpr std::int64_t most = index_limit(std::int64_t{1} << 40);  // a limit on damaged files
  const auto number = parse_integer(trimmed(*text));
  if (!number || *number < 0 || *number > most)
    fail(std::string(attribute) + " " + in_quotes(*text) + " is not a number of items");
  return *number;
}

std::optional<Eigen::VectorXd> VtkReader::numbers(const XmlElement& element, std::string_view attribute,
                                                  Index expected) const {
  const std::string* text = element.attribute(attribute);
  if (text == nullptr) return std::nullopt;
  Eigen::VectorXd found(expected);
  std::string_view rest = *text;
  for (double& value : found) {
    const auto number = parse_number(take_word(rest));
    if (!number || !std::isfinite(*number))
      fail(std::string(attribute) + " " + in_quotes(*text) + ": expected " + std::to_string(expected) + " numbers");
    value = *number;
  }
  return found;
}

SampleType VtkReader::type(const XmlElement& array) const {
  const std::string* name = array.attribute("type");
  const auto found = std::find(type_names.begin(), type_names.end(), name == nullptr ? "" : *name);
  if (found == type_names.end()) fail(name_of_array(array) + " has a type other than UInt8 to Float64");
  return static_cast<SampleType>(found - type_names.begin());
}

Index VtkReader::components(const XmlElement& array) const {
  constexpr Index most = 1 << 16;  // a limit on damaged files
  const Index components = array.attribute("NumberOfComponents") == nullptr ? 1 : count(array, "NumberOfComponents");
  if (components < 1 || components > most)
    fail(name_of_array(array) + " has " + std::to_string(components) + " components");
  return components;
}

std::string VtkReader::bytes(const XmlElement& array, Index tuples) const {
  const std::size_t samples = static_cast<std::size_t>(tuples) * static_cast<std::size_t>(components(array));
  const std::size_t size = samples * sample_size(type(array));
  const std::string* format = array.attribute("format");
  if (format == nullptr || *format == "ascii") return ascii(array, samples);
  const bool is_appended = *format == "appended";
  std::string_view text = array.text;
  if (is_appended) {
    const auto offset = static_cast<std::size_t>(count(array, "offset"));
    if (offset > appended_.size()) fail(name_of_array(array) + " begins beyond the end of the file");
    text = appended_.substr(offset);
  }
  const std::string where = name_ + ": " + name_of_array(array);
  BlockReader reader({text, !is_appended || appended_is_base64_}, header_size_, order_, where);
  return compressed_ ? reader.read_compressed(size) : reader.read_plain(size);
}

std::string VtkReader::ascii(const XmlElement& array, std::size_t samples) const {
  // A sample takes a digit and a separator.
  if (samples > (array.text.size() + 1) / 2) fail(name_of_array(array) + " is truncated");
  return with_sample_type(type(array), [&](auto sample) {
    using T = decltype(sample);
    std::string bytes(samples * sizeof(T), '\0');
    std::string_view rest = array.text;
    for (std::size_t i = 0; i < samples; ++i) {
      rest.remove_prefix(std::min(rest.find_first_not_of(" \t\r\n"), rest.size()));
      const std::string_view word = rest.substr(0, rest.find_first_of(" \t\r\n"));
      rest.remove_prefix(word.size());
      const auto value = parse_number(word);
      if (!value) fail(name_of_array(array) + ": " + in_quotes(word) + " is not a number");
      store_scalar(bytes.data() + i * sizeof(T), narrow_scalar<T>(*value));
    }
    if (order_ == std::endian::big)
      for (std::size_t i = 0; i < samples; ++i)
        std::reverse(bytes.data() + i * sizeof(T), bytes.data() + (i + 1) * sizeof(T));
    return bytes;
  });
}

Eigen::MatrixXd VtkReader::values(const XmlElement& array, Index tuples) const {
  const std::string raw = bytes(array, tuples);
  return with_sample_type(type(array), [&](auto sample) {
    using T = decltype(sample);
    Eigen::MatrixXd values(components(array), tuples);
    const char* in = raw.data();
    for (Index i = 0; i < tuples; ++i)
      for (Index row = 0; row < values.rows(); ++row, in += sizeof(T))
        values(row, i) = static_cast<double>(load_scalar<T>(in, order_));
    return values;
  });
}

}  // namespace csrbf
