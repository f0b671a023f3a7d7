#include "csrbf/io/vtk/xml.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/text.hpp"

namespace csrbf {
namespace {

constexpr std::string_view blanks = " \t\r\n";

struct Entity {
  char character;
  std::string_view name;
};

constexpr std::array<Entity, 5> entities{
    {{'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}, {'\'', "&apos;"}}};

std::string unescaped(std::string_view text) {
  std::string plain;
  while (!text.empty()) {
    std::size_t taken = 1;
    char character = text.front();
    for (const Entity& entity : entities)
      if (text.starts_with(entity.name)) {
        taken = entity.name.size();
        character = entity.character;
      }
    plain += character;
    text.remove_prefix(taken);
  }
  return plain;
}

class XmlParser {
 public:
  XmlParser(std::string_view bytes, std::string_view opaque, const std::string& name)
      : rest_(bytes), opaque_(opaque), name_(name) {}

  XmlElement parse() {
    skip_to_tag();
    if (rest_.empty()) throw IoError(name_ + ": not an XML file");
    return read_element(0);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw IoError(name_ + ": " + what); }

  std::string_view take_until(std::string_view end, const std::string& where) {
    const std::size_t at = rest_.find(end);
    if (at == std::string_view::npos) fail("the file ends within " + where);
    const std::string_view taken = rest_.substr(0, at);
    rest_.remove_prefix(at + end.size());
    return taken;
  }

  // Moves to the next tag of an element, past text, declarations and comments; returns what was skipped.
  std::string_view skip_to_tag() {
    const std::string_view from = rest_;
    while (true) {
      const std::size_t at = rest_.find('<');
      rest_.remove_prefix(std::min(at, rest_.size()));
      if (rest_.starts_with("<!--"))
        take_until("-->", "a comment");
      else if (rest_.starts_with("<?") || rest_.starts_with("<!"))
        take_until(">", "a declaration");
      else
        return from.substr(0, from.size() - rest_.size());
    }
  }

  XmlElement read_element(int depth) {
    constexpr int most_levels = 32;  // bounds the recursion; VTK files have five
    if (depth >= most_levels) fail("more than 32 levels of XML elements");
    rest_.remove_prefix(1);
    XmlElement element{.name = std::string(take_name())};
    if (element.name.empty()) fail("an XML tag without a name");
    if (read_attributes(element)) return element;
    if (element.name == opaque_) {
      element.text = rest_;
      rest_ = {};
      return element;
    }
    while (true) {
      const std::string_view text = skip_to_tag();
      if (rest_.empty()) fail("the file ends within the element " + in_quotes(element.name));
      if (element.children.empty()) element.text = text;
      if (rest_.starts_with("</")) break;
      element.children.push_back(read_element(depth + 1));
      if (rest_.empty()) return element;
    }
    rest_.remove_prefix(2);
    const std::string_view end = trimmed(take_until(">", "a tag"));
    if (end != element.name) fail("element " + in_quotes(element.name) + " is closed as " + in_quotes(end));
    return element;
  }

  std::string_view take_name() {
    const std::size_t end = std::min(rest_.find_first_of(" \t\r\n=/>"), rest_.size());
    const std::string_view word = rest_.substr(0, end);
    rest_.remove_prefix(end);
    return word;
  }

  void skip_blanks() { rest_.remove_prefix(std::min(rest_.find_first_not_of(blanks), rest_.size())); }

  // Reads to the end of the tag; true when the element ends with it.
  bool read_attributes(XmlElement& element) {
    while (true) {
      skip_blanks();
      if (rest_.empty()) fail("the file ends within the tag " + in_quotes(element.name));
      if (rest_.front() == '>' || rest_.starts_with("/>")) {
        const bool ends = rest_.front() == '/';
        rest_.remove_prefix(ends ? 2 : 1);
        return ends;
      }
      const std::string_view key = take_name();
      skip_blanks();
      if (key.empty() || !rest_.starts_with('=')) fail("tag " + in_quotes(element.name) + ": expected name=\"value\"");
      rest_.remove_prefix(1);
      skip_blanks();
      if (!rest_.starts_with('"') && !rest_.starts_with('\''))
        fail("tag " + in_quotes(element.name) + ": the value of " + in_quotes(key) + " is not in quotes");
      const std::string quote(1, rest_.front());
      rest_.remove_prefix(1);
      element.attributes.emplace_back(key, unescaped(take_until(quote, "a value")));
    }
  }

  std::string_view rest_;
  std::string_view opaque_;
  const std::string& name_;
};

}  // namespace

const std::string* XmlElement::attribute(std::string_view wanted) const {
  for (const auto& [key, value] : attributes)
    if (key == wanted) return &value;
  return nullptr;
}

const XmlElement* XmlElement::child(std::string_view wanted) const {
  for (const XmlElement& element : children)
    if (element.name == wanted) return &element;
  return nullptr;
}

XmlElement parse_xml(std::string_view bytes, std::string_view opaque, const std::string& name) {
  return XmlParser(bytes, opaque, name).parse();
}

std::string xml_escaped(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    std::string_view piece(&c, 1);
    for (const Entity& entity : entities)
      if (entity.character == c) piece = entity.name;
    escaped += piece;
  }
  return escaped;
}

}  // namespace csrbf
