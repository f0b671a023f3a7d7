#include "csrbf/io/geometry/formats.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/interruption.hpp"
#include "csrbf/io/geometry/ply_body.hpp"
#include "csrbf/io/geometry/properties.hpp"

namespace csrbf {
namespace {

// Where the values of a vertex property are stored: data[stride * i] for vertex i.
struct Slot {
  double* data = nullptr;
  Index stride = 1;
};

const PlyProperty* find_scalar(const PlyElement& element, std::string_view name) {
  for (const PlyProperty& p : element.properties)
    if (!p.count_type && p.name == name) return &p;
  return nullptr;
}

bool is_edges(const PlyElement& element) {
  return element.name == "edge" && find_scalar(element, "vertex1") != nullptr &&
         find_scalar(element, "vertex2") != nullptr;
}

// One slot per property; those of lists stay empty.
std::vector<Slot> make_vertex_slots(const PlyElement& element, const std::string& name, Mesh& mesh) {
  constexpr std::string_view positions[] = {"x", "y", "z"};
  constexpr std::string_view normals[] = {"nx", "ny", "nz"};
  for (const std::string_view axis : positions)
    if (find_scalar(element, axis) == nullptr)
      throw IoError(name + ": the vertices have no property " + in_quotes(axis));
  const bool has_normals = std::all_of(std::begin(normals), std::end(normals),
                                       [&](std::string_view n) { return find_scalar(element, n) != nullptr; });
  mesh.vertices.resize(3, element.count);
  mesh.normals.resize(3, has_normals ? element.count : 0);
  if (element.count == 0) return {};  // a slot would have nothing to point to

  std::vector<Slot> slots(element.properties.size());
  mesh.properties.reserve(element.properties.size());
  for (std::size_t i = 0; i < slots.size(); ++i) {
    const PlyProperty& p = element.properties[i];
    if (p.count_type) continue;
    for (int axis = 0; axis < 3; ++axis) {
      if (p.name == positions[axis]) slots[i] = {mesh.vertices.data() + axis, 3};
      if (has_normals && p.name == normals[axis]) slots[i] = {mesh.normals.data() + axis, 3};
    }
    if (slots[i].data != nullptr) continue;
    mesh.properties.push_back({p.name, std::string(name_of(p.type, property_types)), Eigen::VectorXd(element.count)});
    slots[i] = {mesh.properties.back().values.data(), 1};
  }
  return slots;
}

template <class Body>
Index read_list_size(Body& body, const PlyProperty& property) {
  const double size = body.scalar(*property.count_type);
  if (!(size >= 0) || size != std::floor(size)) body.fail("a list has an impossible length");
  // In text the last item needs no separator after it.
  if (size > static_cast<double>(body.room_for(property.type)) + 1) body.fail("a list is longer than the file");
  return static_cast<Index>(size);
}

template <class Body>
void skip_property(Body& body, const PlyProperty& property) {
  const Index values = property.count_type ? read_list_size(body, property) : 1;
  for (Index i = 0; i < values; ++i) body.scalar(property.type);
}

constexpr unsigned elements_between_breaks = 1U << 13;  // vertices or faces

template <class Body>
void read_vertices(Body& body, const PlyElement& element, const std::vector<Slot>& slots) {
  InterruptionPoint pause(elements_between_breaks);
  for (Index i = 0; i < element.count; ++i) {
    pause();
    body.begin(element, i);
    for (std::size_t p = 0; p < slots.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      if (slots[p].data != nullptr)
        slots[p].data[slots[p].stride * i] = body.scalar(property.type);
      else
        skip_property(body, property);
    }
    body.end();
  }
}

template <class Body>
[[noreturn]] void fail_index(const Body& body, double value, Index vertices) {
  std::string message = "vertex index ";
  append_number(message, value);
  body.fail(message + " is not one of the " + std::to_string(vertices) + " vertices");
}

template <class Body>
std::int32_t checked_index(const Body& body, double value, Index vertices) {
  if (!(value >= 0 && value < static_cast<double>(vertices)) || value != std::floor(value))
    fail_index(body, value, vertices);
  return static_cast<std::int32_t>(value);
}

template <class Body>
void read_polygon(Body& body, const PlyProperty& property, Index vertices, std::vector<std::int32_t>& corners) {
  const Index size = read_list_size(body, property);
  std::int32_t first = 0;
  std::int32_t previous = 0;
  for (Index i = 0; i < size; ++i) {
    const std::int32_t index = checked_index(body, body.scalar(property.type), vertices);
    if (i == 0) first = index;
    if (i >= 2) corners.insert(corners.end(), {first, previous, index});
    previous = index;
  }
}

// Every corner after the second makes a triangle with the two before it, turned every other time; -1 begins anew.
template <class Body>
void read_strip(Body& body, const PlyProperty& property, Index vertices, std::vector<std::int32_t>& corners) {
  const Index size = read_list_size(body, property);
  std::array<std::int32_t, 2> before{};
  Index done = 0;
  for (Index i = 0; i < size; ++i) {
    const double value = body.scalar(property.type);
    if (value == -1) {
      done = 0;
      continue;
    }
    const std::int32_t index = checked_index(body, value, vertices);
    const bool repeats = index == before[0] || index == before[1] || before[0] == before[1];
    if (done >= 2 && !repeats) corners.insert(corners.end(), {before[done % 2], before[1 - done % 2], index});
    before = {before[1], index};
    ++done;
  }
}

// The list of vertices of a face: that of the usual name, else the first of whole numbers.
const PlyProperty* find_corners(const PlyElement& element) {
  const PlyProperty* found = nullptr;
  for (const PlyProperty& p : element.properties) {
    if (!p.count_type || is_floating(p.type)) continue;
    if (p.name == "vertex_indices" || p.name == "vertex_index") return &p;
    if (found == nullptr) found = &p;
  }
  return found;
}

template <class Body>
void read_faces(Body& body, const PlyElement& element, Index vertices, std::vector<std::int32_t>& corners) {
  const PlyProperty* const list = find_corners(element);
  corners.reserve(3 * element.count);
  InterruptionPoint pause(elements_between_breaks);
  for (Index i = 0; i < element.count; ++i) {
    pause();
    body.begin(element, i);
    for (const PlyProperty& p : element.properties) {
      if (&p == list && element.name == "tristrips")
        read_strip(body, p, vertices, corners);
      else if (&p == list)
        read_polygon(body, p, vertices, corners);
      else
        skip_property(body, p);
    }
    body.end();
  }
}

template <class Body>
void read_edges(Body& body, const PlyElement& element, Index vertices, std::vector<std::int32_t>& ends) {
  ends.assign(2 * element.count, 0);
  for (Index i = 0; i < element.count; ++i) {
    body.begin(element, i);
    for (const PlyProperty& p : element.properties) {
      const bool first = p.name == "vertex1";
      if (p.count_type || (!first && p.name != "vertex2")) {
        skip_property(body, p);
        continue;
      }
      ends[2 * i + (first ? 0 : 1)] = checked_index(body, body.scalar(p.type), vertices);
    }
    body.end();
  }
}

template <class Body>
void skip_element(Body& body, const PlyElement& element) {
  for (Index i = 0; i < element.count; ++i) {
    body.begin(element, i);
    for (const PlyProperty& p : element.properties) skip_property(body, p);
    body.end();
  }
}

struct PlyContent {
  Mesh mesh;
  std::vector<std::int32_t> edges;
};

template <class Body>
PlyContent read_body(Body&& body, const PlyHeader& header, const PlyElement& vertex, const std::string& name) {
  PlyContent content;
  Mesh& mesh = content.mesh;
  std::vector<std::int32_t> corners;
  for (const PlyElement& element : header.elements) {
    body.expect(element);
    if (&element == &vertex)
      read_vertices(body, element, make_vertex_slots(element, name, mesh));
    else if (element.name == "face" || element.name == "tristrips")
      read_faces(body, element, vertex.count, corners);
    else if (is_edges(element))
      read_edges(body, element, vertex.count, content.edges);
    else
      skip_element(body, element);
  }
  mesh.triangles = Eigen::Map<const Triangles>(corners.data(), 3, static_cast<Index>(corners.size() / 3));
  return content;
}

const PlyElement& find_vertices(const PlyHeader& header, const std::string& name) {
  for (const PlyElement& element : header.elements) {
    if (element.name != "vertex") continue;
    if (element.count > std::numeric_limits<std::int32_t>::max()) throw IoError(name + ": more than 2^31 - 1 vertices");
    return element;
  }
  throw IoError(name + ": the file has no vertices");
}

template <class T>
void append_value(std::string& out, double value) {
  append_scalar(out, narrow_scalar<T>(value));
}

using Append = void (*)(std::string&, double);

Append appender(SampleType type) {
  return with_sample_type(type, [](auto sample) -> Append { return append_value<decltype(sample)>; });
}

SampleType checked_type(const Property& property) {
  const auto type = ply_type(property.type);
  require(type.has_value(), "write PLY", "type of property " + property.name, property.type,
          "must be char, uchar, short, ushort, int, uint, float or double");
  return *type;
}

// The data of the vertices; `normals` has no columns when there are none.
struct VertexColumns {
  const Points<3>& positions;
  const Points<3>& normals;
  const std::vector<Property>& properties;
  SampleType position_type = float_coordinate_loss(positions) > 0 ? SampleType::float64 : SampleType::float32;
};

std::string format_header(const VertexColumns& columns) {
  const Index vertices = columns.positions.cols();
  require(columns.normals.cols() == 0 || columns.normals.cols() == vertices, "write PLY", "normals",
          columns.normals.cols(), "none or one per vertex is needed");
  std::string out = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(vertices) + "\n";
  for (const char axis : {'x', 'y', 'z'})
    out += "property " + std::string(name_of(columns.position_type, property_types)) + " " + axis + "\n";
  if (columns.normals.cols() > 0) out += "property float nx\nproperty float ny\nproperty float nz\n";
  for (const Property& p : columns.properties)
    out += "property " + std::string(name_of(checked_type(p), property_types)) + " " + single_word(p.name) + "\n";
  return out;
}

void append_vertices(std::string& out, const VertexColumns& columns) {
  const auto& [positions, normals, properties, position_type] = columns;
  const Index vertices = positions.cols();
  const Append append_coordinate = appender(position_type);
  std::vector<Append> append;
  for (const Property& p : properties) append.push_back(appender(checked_type(p)));
  out.reserve(out.size() + static_cast<std::size_t>(vertices) * (36 + 8 * append.size()));
  InterruptionPoint pause(elements_between_breaks);
  for (Index i = 0; i < vertices; ++i) {
    pause();
    for (int axis = 0; axis < 3; ++axis) append_coordinate(out, positions(axis, i));
    for (int axis = 0; axis < 3 && normals.cols() > 0; ++axis) append_value<float>(out, normals(axis, i));
    for (std::size_t p = 0; p < append.size(); ++p) append[p](out, properties[p].values(i));
  }
}

PlyContent parse(std::string_view bytes, const std::string& name) {
  LineReader reader(bytes, name);
  const PlyHeader header = parse_ply_header(reader);
  const PlyElement& vertex = find_vertices(header, name);
  switch (header.encoding) {
    case PlyEncoding::ascii:
      return read_body(PlyTextBody(reader), header, vertex, name);
    case PlyEncoding::little_endian:
      return read_body(PlyBinaryBody<std::endian::little>(reader.rest(), name), header, vertex, name);
    case PlyEncoding::big_endian:
      break;
  }
  return read_body(PlyBinaryBody<std::endian::big>(reader.rest(), name), header, vertex, name);
}

}  // namespace

Mesh parse_ply(std::string_view bytes, const std::string& name) {
  return parse(bytes, name).mesh;
}

Polylines parse_ply_polylines(std::string_view bytes, const std::string& name) {
  PlyContent content = parse(bytes, name);
  Polylines lines;
  lines.vertices = std::move(content.mesh.vertices);
  lines.properties = std::move(content.mesh.properties);
  lines.edges = Eigen::Map<const Eigen::Matrix<std::int32_t, 2, Eigen::Dynamic>>(
      content.edges.data(), 2, static_cast<Index>(content.edges.size() / 2));
  return lines;
}

bool is_ply_of_polylines(std::string_view bytes) {
  try {
    LineReader reader(bytes, "");
    const PlyHeader header = parse_ply_header(reader);
    const auto has = [&](const auto& wanted) {
      return std::any_of(header.elements.begin(), header.elements.end(),
                         [&](const PlyElement& e) { return e.count > 0 && wanted(e); });
    };
    return has(is_edges) && !has([](const PlyElement& e) { return e.name == "face" || e.name == "tristrips"; });
  } catch (const IoError&) {
    return false;
  }
}

std::string format_ply(const Mesh& mesh) {
  const VertexColumns columns{mesh.vertices, mesh.normals, mesh.properties};
  std::string out = format_header(columns);
  if (mesh.triangles.cols() > 0)
    out += "element face " + std::to_string(mesh.triangles.cols()) + "\nproperty list uchar int vertex_indices\n";
  out += "end_header\n";
  append_vertices(out, columns);
  constexpr std::size_t bytes_per_face = 13;
  out.reserve(out.size() + bytes_per_face * static_cast<std::size_t>(mesh.triangles.cols()));
  InterruptionPoint pause(elements_between_breaks);
  for (Index t = 0; t < mesh.triangles.cols(); ++t) {
    pause();
    append_scalar(out, std::uint8_t{3});
    for (int corner = 0; corner < 3; ++corner) append_scalar(out, mesh.triangles(corner, t));
  }
  return out;
}

std::string format_ply(const Polylines& lines) {
  const Points<3> no_normals(3, 0);
  const VertexColumns columns{lines.vertices, no_normals, lines.properties};
  std::string out = format_header(columns);
  out += "element edge " + std::to_string(lines.edges.cols()) +
         "\nproperty int vertex1\nproperty int vertex2\nend_header\n";
  append_vertices(out, columns);
  for (Index e = 0; e < lines.edges.size(); ++e) append_scalar(out, lines.edges.data()[e]);
  return out;
}

}  // namespace csrbf
