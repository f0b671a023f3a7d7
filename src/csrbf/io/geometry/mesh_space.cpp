#include "csrbf/io/geometry/mesh_space.hpp"

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

}  // namespace

std::string with_space(std::string bytes, std::string_view extension, Space space) {
  if (space == Space::unknown) return bytes;
  const std::string name = space == Space::right_anterior_superior ? "RAS" : "LPS", text = "SPACE=" + name;
  if (extension == ".obj") return "# " + text + '\n' + std::move(bytes);
  if (extension == ".ply") return with_after(std::move(bytes), "1.0\n", "comment " + text + '\n');
  if (extension == ".vtp") return with_after(std::move(bytes), "<PolyData>\n", field_data(name));
  constexpr std::size_t after_title = 11;  // of the 80 bytes before the triangles: "binary STL "
  if (extension == ".stl") bytes.replace(after_title, text.size(), text);
  return bytes;
}

}  // namespace csrbf
