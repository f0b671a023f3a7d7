#pragma once

#include "csrbf/core/error.hpp"
#include "csrbf/io/geometry/ply_header.hpp"

namespace csrbf {

// Both bodies are read the same way: expect(element), then for each of its items begin(), one scalar() per value and
// end(). No value is read beyond the end of the file; every failure is an IoError with its position.

/// The values after a text header: one element per line.
class PlyTextBody {
 public:
  explicit PlyTextBody(LineReader& reader) : reader_(reader) {}

  void expect(const PlyElement& element) {
    if (!reader_.can_hold(element.count, std::ssize(element.properties)))
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

  double scalar(SampleType) {
    const std::string_view word = take_word(rest_);
    if (word.empty()) wrong_number_of_values();
    return reader_.number(word);
  }

  [[nodiscard]] std::size_t room_for(SampleType) const { return rest_.size() / 2; }

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

  double scalar(SampleType type) {
    return with_sample_type(type, [&](auto sample) {
      if (left() < sizeof(sample)) fail("the file ends here");
      position_ += sizeof(sample);
      return static_cast<double>(load_scalar<decltype(sample)>(&bytes_[position_ - sizeof(sample)], Order));
    });
  }

  [[nodiscard]] std::size_t room_for(SampleType type) const { return left() / sample_size(type); }

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
