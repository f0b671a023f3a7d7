#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace csrbf {

/// An element of an XML text, with its content.
struct XmlElement {
  std::string name;
  std::vector<std::pair<std::string, std::string>> attributes = {};
  std::vector<XmlElement> children = {};
  std::string_view text = {};  ///< of an element without children, as in the file

  /// The value of an attribute; null when there is none.
  [[nodiscard]] const std::string* attribute(std::string_view wanted) const;
  /// The first child of that name; null when there is none.
  [[nodiscard]] const XmlElement* child(std::string_view wanted) const;
};

/// Reads the outermost element of an XML text; declarations and comments are skipped. The text of the element named
/// `opaque` is all of `bytes` after its tag, and reading ends there. `bytes` must outlive the result. Throws IoError
/// with `name` for tags that do not match and for more than 32 levels.
XmlElement parse_xml(std::string_view bytes, std::string_view opaque, const std::string& name);

/// `text` as the value of an attribute or as the text of an element.
std::string xml_escaped(std::string_view text);

}  // namespace csrbf
