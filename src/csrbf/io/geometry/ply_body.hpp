#pragma once

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/bytes.hpp"
#include "csrbf/io/geometry/ply_header.hpp"

namespace csrbf {

// Both bodies are read the same way: expect(element), then for each of its items begin(), one scalar() per value and
// end(). No value is read beyond the end of the file; every failure is an IoError with its position.

/// The values after a text header: one element per line.
class PlyTextBody {
 public:
  explicit PlyTextBody(LineReader& reader) : reader_(reader) {}

  void expect(const PlyElement& element) {
    if (!reader_.can_hold(element.count, element.properties.size()))
      throw IoError(reader_.name() + ": the header promises " + std::to_string(element.count) + " " + element.name +
                    " elements, more than the file can hold");
  }

  void begin(const PlyElement& element, Index index) {
    element_ = &element;
    if (!reader_.next())
      reader_.fail("the file ends after " + std::to_string(index) + " of " + std::to_string(element.count) + " " +
                   element.name + " elements");
    rest_ = reader_.line();
  }

  double scalar(PlyType) {
    const std::string_view word = take_word(rest_);
    if (word.empty()) wrong_number_of_values();
    const std::optional<double> value = parse_number(word);
    if (!value) reader_.fail(in_quotes(word) + " is not a number");
    return *value;
  }

  [[nodiscard]] std::size_t room_for(PlyType) const { return rest_.size() / 2; }

  void end() {
    if (count_words(rest_) > 0) wrong_number_of_values();
  }

  [[noreturn]] void fail(const std::string& message) const { reader_.fail(message); }

 private:
  [[noreturn]] void wrong_number_of_values() const {
    if (element_->has_lists()) reader_.fail("the line does not match the properties of element " + element_->name);
    const bool only_position = element_->name == "vertex" && element_->properties.size() == 3;
    reader_.fail("expected " + std::to_string(element_->properties.size()) +
                 (only_position ? " coordinates, found " : " values, found ") +
                 std::to_string(count_words(reader_.line())));
  }

  LineReader& reader_;
  std::string_view rest_;
  const PlyElement* element_ = nullptr;
};

/// The values after a binary header.
template <std::endian Order>
class PlyBinaryBody {
 public:
  PlyBinaryBody(std::string_view bytes, std::string name) : bytes_(bytes), name_(std::move(name)) {}

  void expect(const PlyElement& element) {
    const std::size_t size = element.smallest_binary_size();
    if (size > 0 && static_cast<std::size_t>(element.count) > left() / size)
      throw IoError(name_ + ": the file is truncated: the header promises " + std::to_string(element.count) + " " +
                    element.name + " elements, there is room for " + std::to_string(left() / size));
  }

  void begin(const PlyElement& element, Index index) {
    element_ = &element;
    index_ = index;
  }

  double scalar(PlyType type) {
    const std::size_t size = ply_type_size(type);
    if (left() < size) fail("the file ends here");
    const char* value = bytes_.data() + position_;
    position_ += size;
    switch (type) {
      case PlyType::char_:
        return load_scalar<std::int8_t>(value, Order);
      case PlyType::uchar:
        return load_scalar<std::uint8_t>(value, Order);
      case PlyType::short_:
        return load_scalar<std::int16_t>(value, Order);
      case PlyType::ushort:
        return load_scalar<std::uint16_t>(value, Order);
      case PlyType::int_:
        return load_scalar<std::int32_t>(value, Order);
      case PlyType::uint:
        return load_scalar<std::uint32_t>(value, Order);
      case PlyType::float_:
        return static_cast<double>(load_scalar<float>(value, Order));
      case PlyType::double_:
        break;
    }
    return load_scalar<double>(value, Order);
  }

  [[nodiscard]] std::size_t room_for(PlyType type) const { return left() / ply_type_size(type); }

  void end() {}

  [[noreturn]] void fail(const std::string& message) const {
    throw IoError(name_ + ": " + element_->name + " " + std::to_string(index_) + ": " + message);
  }

 private:
  [[nodiscard]] std::size_t left() const { return bytes_.size() - position_; }

  std::string_view bytes_;
  std::string name_;
  std::size_t position_ = 0;
  const PlyElement* element_ = nullptr;
  Index index_ = 0;
};

}  // namespace csrbf
