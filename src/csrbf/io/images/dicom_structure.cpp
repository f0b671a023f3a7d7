#include "csrbf/io/images/dicom_structure.hpp"

#include "csrbf/io/files/bytes.hpp"

namespace csrbf::dicom {
namespace {

constexpr std::size_t preamble = 132;
constexpr std::uint32_t undefined_length = 0xffffffff;
constexpr int deepest = 32;  // nested sequences; bounds the recursion, far above what real files have

constexpr std::uint32_t group_length = 0x00020000, transfer_syntax = 0x00020010, item = 0xfffee000,
                        end_of_item = 0xfffee00d, end_of_sequence = 0xfffee0dd, pixel_data = 0x7fe00010;

// Data elements (PS3.5 section 7): tag, type unless it is implicit, length, value.
struct Element {
  std::uint32_t tag = 0;
  std::uint32_t length = 0;
  bool of_unknown_type = false;
  std::string_view value;  // empty when the length is undefined
};

// Is a two-letter type in the blank-separated list?
bool holds(std::string_view list, std::string_view type) {
  for (std::size_t i = 0; i < list.size(); i += 3)
    if (list.substr(i, 2) == type) return true;
  return false;
}

class Walker {
 public:
  explicit Walker(std::string_view bytes) : bytes_(bytes) {}

  [[nodiscard]] bool at_end() const { return bytes_.empty(); }
  [[nodiscard]] std::string_view rest() const { return bytes_; }

  // Takes tag, type and length, and the value unless its length is undefined. False when something is missing.
  bool take(bool implicit, Element& element) {
    if (bytes_.size() < 8) return false;
    element.tag = std::uint32_t{number<std::uint16_t>(0)} << 16 | number<std::uint16_t>(2);
    const bool delimits = element.tag >> 16 == item >> 16;
    element.of_unknown_type = false;
    std::size_t header = 8;
    if (implicit || delimits) {
      element.length = number<std::uint32_t>(4);
    } else {
      const std::string_view type = bytes_.substr(4, 2);
      constexpr std::string_view long_types = "OB OD OF OL OV OW SQ SV UC UN UR UT UV",
                                 short_types = "AE AS AT CS DA DS DT FD FL IS LO LT PN SH SL SS ST TM UI UL US";
      element.of_unknown_type = type == "UN";
      const bool is_long = holds(long_types, type);
      if (!is_long && !holds(short_types, type)) return false;
      if (is_long && bytes_.size() < 12) return false;
      header = is_long ? 12 : 8;
      element.length = is_long ? number<std::uint32_t>(8) : number<std::uint16_t>(6);
    }
    bytes_.remove_prefix(header);
    element.value = {};
    if (element.length == undefined_length) return true;
    if (bytes_.size() < element.length) return false;
    element.value = bytes_.substr(0, element.length);
    bytes_.remove_prefix(element.length);
    return true;
  }

  // Elements up to the end, or to a delimiter of items.
  bool take_elements(bool implicit, bool within_item, int depth) {
    for (Element element; within_item || !at_end();) {
      if (!take(implicit, element)) return false;
      if (element.tag == end_of_item) return within_item && element.length == 0;
      if (element.tag >> 16 == item >> 16) return false;
      if (element.length != undefined_length) continue;
      const bool fragments = element.tag == pixel_data;
      // Sequences of unknown type are implicit (CP-246).
      if (!take_items(implicit || element.of_unknown_type, fragments, depth + 1)) return false;
    }
    return true;
  }

 private:
  // The items of a sequence of undefined length, with its end.
  bool take_items(bool implicit, bool fragments, int depth) {
    if (depth > deepest) return false;
    for (Element element;;) {
      if (!take(true, element)) return false;
      if (element.tag == end_of_sequence) return element.length == 0;
      if (element.tag != item) return false;
      if (element.length != undefined_length) {
        Walker within(element.value);
        if (!fragments && !within.take_elements(implicit, false, depth + 1)) return false;
      } else if (fragments || !take_elements(implicit, true, depth + 1)) {
        return false;
      }
    }
  }

  template <class T>
  [[nodiscard]] T number(std::size_t at) const {
    return load_scalar<T>(bytes_.data() + at);
  }

  std::string_view bytes_;
};

}  // namespace

bool has_preamble(std::string_view bytes) {
  return bytes.size() >= preamble && bytes.substr(preamble - 4, 4) == "DICM";
}

bool is_whole(std::string_view bytes) {
  if (!has_preamble(bytes)) return false;
  Walker file(bytes.substr(preamble));
  Element element;
  if (!file.take(false, element) || element.tag != group_length || element.length != 4) return false;
  const auto meta_bytes = load_scalar<std::uint32_t>(element.value.data());
  if (file.rest().size() < meta_bytes) return false;
  std::string_view syntax;
  for (Walker meta(file.rest().substr(0, meta_bytes)); !meta.at_end();) {
    if (!meta.take(false, element) || element.length == undefined_length) return false;
    if (element.tag == transfer_syntax) syntax = element.value.substr(0, element.value.find('\0'));
  }
  constexpr std::string_view implicit = "1.2.840.10008.1.2", big_endian = "1.2.840.10008.1.2.2",
                             deflated = "1.2.840.10008.1.2.1.99";
  if (syntax == big_endian || syntax == deflated) return true;
  return !syntax.empty() && Walker(file.rest().substr(meta_bytes)).take_elements(syntax == implicit, false, 0);
}

}  // namespace csrbf::dicom
