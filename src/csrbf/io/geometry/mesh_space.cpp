#include "csrbf/io/geometry/mesh_space.hpp"

#include <sstream>

namespace csrbf {
namespace {

// The bytes with a text after the first occurrence of another.
std::string with_after(std::string bytes, std::string_view place, const std::string& text) {
  const std::size_t at = bytes.find(place);
  if (at != std::string::npos) bytes.insert(at + place.size(), text);
  return bytes;
}

// VTK writes strings as the numbers of their characters, and 0.
std::string field_data(std::string_view value) {
  std::string characters;
  for (const char each : value) characters += std::to_string(static_cast<int>(each)) + " ";
  return "<FieldData>\n<Array type=\"String\" Name=\"SPACE\" NumberOfTuples=\"1\" format=\"ascii\">" + characters +
         "0</Array>\n</FieldData>\n";
}

std::string characters_of(std::string_view numbers) {
  std::istringstream stream{std::string(numbers.substr(0, numbers.find('<')))};
  std::string text;
  for (int each = 0; stream >> each && each != 0;) text += static_cast<char>(each);
  return text;
}

std::string_view first_word(std::string_view text) {
  return text.substr(0, text.find_first_of(std::string_view(" \t\r\n\0", 5)));
}

// What follows a mark; nothing without it.
std::string_view after(std::string_view mark, std::string_view text) {
  const std::size_t at = text.find(mark);
  return at == std::string_view::npos ? std::string_view() : text.substr(at + mark.size());
}

}  // namespace

std::string with_space(std::string bytes, std::string_view extension, Space space) {
  if (space == Space::unknown) return bytes;
  const std::string name = space_name(space), text = "SPACE=" + name;
  if (extension == ".obj") return "# " + text + '\n' + std::move(bytes);
  if (extension == ".ply") return with_after(std::move(bytes), "1.0\n", "comment " + text + '\n');
  if (extension == ".vtp") return with_after(std::move(bytes), "<PolyData>\n", field_data(name));
  constexpr std::size_t after_title = 11;  // of the 80 bytes before the triangles: "binary STL "
  if (extension == ".stl") bytes.replace(after_title, text.size(), text);
  return bytes;
}

Space space_in(std::string_view bytes, std::string_view extension) {
  constexpr std::size_t title_of_stl = 80;
  std::string_view said;
  if (extension == ".ply") said = after("comment SPACE=", bytes.substr(0, bytes.find("end_header")));
  if (extension == ".obj") said = after("# SPACE=", bytes.substr(0, bytes.find("\nv ")));
  if (extension == ".stl") said = after("SPACE=", bytes.substr(0, title_of_stl));
  std::string text(first_word(said));
  if (extension == ".vtp")
    text = characters_of(after(">", after("Name=\"SPACE\"", bytes.substr(0, bytes.find("<Piece")))));
  for (const Space space : {Space::left_posterior_superior, Space::right_anterior_superior})
    if (text == space_name(space)) return space;
  return Space::unknown;
}

}  // namespace csrbf
