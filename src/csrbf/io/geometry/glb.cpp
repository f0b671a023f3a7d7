#include "csrbf/core/error.hpp"
#include "csrbf/io/files/bytes.hpp"
#include "csrbf/io/files/text.hpp"
#include "csrbf/io/geometry/formats.hpp"
#include "csrbf/io/geometry/properties.hpp"

namespace csrbf {
namespace {

// Numbers of glTF 2.0.
constexpr int of_bytes_16 = 5123, of_indices = 5125, of_floats = 5126;
constexpr std::uint32_t magic = 0x46546C67, version = 2, json_chunk = 0x4E4F534A, binary_chunk = 0x004E4942;

// Collects the binary part and the JSON that says what is where.
class GlbParts {
 public:
  // Appends `count` elements, which `write` adds to the binary part, and returns the number of their accessor.
  template <class Write>
  std::string add(Index count, int component, const char* type, const std::string& more, const Write& write) {
    const std::size_t begin = binary_.size();
    write(binary_);
    const std::string number = std::to_string(accessors_);
    append(views_, R"({"buffer":0,"byteOffset":)" + std::to_string(begin) + R"(,"byteLength":)" +
                       std::to_string(binary_.size() - begin) + "}");
    append(descriptions_, R"({"bufferView":)" + number + R"(,"componentType":)" + std::to_string(component) +
                              R"(,"count":)" + std::to_string(count) + R"(,"type":")" + type + "\"" + more + "}");
    ++accessors_;
    return number;
  }

  [[nodiscard]] std::string file(const std::string& primitive, const std::string& node) {
    std::string json =
        R"({"asset":{"version":"2.0","generator":"csrbf"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[)" + node +
        R"(],"meshes":[{"primitives":[)" + primitive +
        R"(]}],"materials":[{"doubleSided":true,"pbrMetallicRoughness":{"metallicFactor":0}}],)" +
        R"("buffers":[{"byteLength":)" + std::to_string(binary_.size()) + R"(}],"bufferViews":[)" + views_ +
        R"(],"accessors":[)" + descriptions_ + "]}";
    constexpr std::size_t alignment = 4, heads = 12 + 8 + 8;
    json.resize((json.size() + alignment - 1) / alignment * alignment, ' ');
    const std::size_t size = heads + json.size() + binary_.size();
    if (size > std::numeric_limits<std::uint32_t>::max())
      throw IoError("a .glb file holds at most 4 GB; write .ply, or a coarser mesh");
    std::string bytes;
    bytes.reserve(size);
    for (const std::uint32_t word :
         {magic, version, static_cast<std::uint32_t>(size), static_cast<std::uint32_t>(json.size()), json_chunk})
      append_scalar(bytes, word);
    bytes += json;
    append_scalar(bytes, static_cast<std::uint32_t>(binary_.size()));
    append_scalar(bytes, binary_chunk);
    return bytes + binary_;
  }

 private:
  static void append(std::string& list, const std::string& item) { list += (list.empty() ? "" : ",") + item; }

  std::string binary_, views_, descriptions_;
  int accessors_ = 0;
};

std::string numbers(const Point<3>& p) {
  std::string text = "[";
  for (Index axis = 0; axis < 3; ++axis) {
    if (axis > 0) text += ",";
    append_number(text, p[axis]);
  }
  return text + "]";
}

std::string add_vectors(GlbParts& parts, const Eigen::MatrixXf& vectors, bool with_bounds) {
  std::string bounds;
  if (with_bounds) {
    const Point<3> lo = vectors.rowwise().minCoeff().cast<double>(), hi = vectors.rowwise().maxCoeff().cast<double>();
    bounds = ",\"min\":" + numbers(lo) + ",\"max\":" + numbers(hi);
  }
  return parts.add(vectors.cols(), of_floats, "VEC3", bounds, [&](std::string& binary) {
    for (const float value : vectors.reshaped()) append_scalar(binary, value);
  });
}

// Colours of glTF are linear in the light, ours as in pictures (sRGB, IEC 61966-2-1).
std::uint16_t linear_color(double byte) {
  constexpr double most = 65535;
  const double c = byte / 255;
  return narrow_scalar<std::uint16_t>(most * (c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4)));
}

std::string add_colors(GlbParts& parts, const ColorColumns& colors, Index count) {
  return parts.add(count, of_bytes_16, "VEC4", ",\"normalized\":true", [&](std::string& binary) {
    for (Index i = 0; i < count; ++i) {
      for (const double component : colors.rgb(i)) append_scalar(binary, linear_color(component));
      append_scalar(binary, std::numeric_limits<std::uint16_t>::max());
    }
  });
}

}  // namespace

std::string format_glb(const Mesh& mesh) {
  const Index count = mesh.vertices.cols();
  if (count == 0 || !mesh.vertices.allFinite())
    throw IoError("a .glb file needs a vertex, and finite coordinates; write .ply");
  const bool moved = float_coordinate_loss(mesh.vertices) > 0;
  const Point<3> middle = moved ? bounding_box<3>(mesh.vertices).center() : Point<3>(Point<3>::Zero());

  GlbParts parts;
  std::string attributes = "\"POSITION\":" + add_vectors(parts, (mesh.vertices.colwise() - middle).cast<float>(), true);
  if (mesh.normals.cols() == count) {
    Points<3> normals = mesh.normals;
    for (Index i = 0; i < count; ++i) {  // the format wants unit vectors
      const double length = normals.col(i).norm();
      normals.col(i) = length > 0 && std::isfinite(length) ? Point<3>(normals.col(i) / length) : Point<3>(0, 0, 1);
    }
    attributes += ",\"NORMAL\":" + add_vectors(parts, normals.cast<float>(), false);
  }
  const ColorColumns colors = find_colors(mesh.properties);
  if (colors.complete()) attributes += ",\"COLOR_0\":" + add_colors(parts, colors, count);

  std::string primitive = "{\"attributes\":{" + attributes + "},\"material\":0";
  if (mesh.triangles.cols() > 0)
    primitive += ",\"indices\":" + parts.add(mesh.triangles.size(), of_indices, "SCALAR", "", [&](std::string& binary) {
      for (const std::int32_t index : mesh.triangles.reshaped())
        append_scalar(binary, static_cast<std::uint32_t>(index));
    });
  else
    primitive += ",\"mode\":0";
  return parts.file(primitive + "}", "{\"mesh\":0" + (moved ? ",\"translation\":" + numbers(middle) : "") + "}");
}

}  // namespace csrbf
