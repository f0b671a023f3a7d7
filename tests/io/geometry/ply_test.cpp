#include "csrbf/io/geometry/formats.hpp"

#include "csrbf/io/files/bytes.hpp"
#include "csrbf/io/geometry/properties.hpp"
#include "csrbf/io/points.hpp"

#include "io/io_testing.hpp"

#include <sstream>

namespace csrbf::ply_test {
namespace {

using testing::io_error;
using testing::TemporaryFolder;

const std::string vertex_header = "element vertex 2\nproperty float x\nproperty float y\nproperty float z\n";

std::string ascii(const std::string& elements, const std::string& body) {
  return "ply\nformat ascii 1.0\ncomment made by hand\n" + elements + "end_header\n" + body;
}

template <class T>
void append(std::string& out, T value, std::endian order) {
  std::string bytes;
  append_scalar(bytes, value);
  if (order == std::endian::big) std::reverse(bytes.begin(), bytes.end());
  out += bytes;
}

// One vertex with every scalar type and a list in between.
std::string every_type(std::endian order) {
  std::string out = "ply\nformat binary_" + std::string(order == std::endian::big ? "big" : "little") +
                    "_endian 1.0\nelement camera 1\nproperty list uchar int16 ids\nproperty double t\n"
                    "element vertex 1\nproperty char a\nproperty uchar b\nproperty int16 c\nproperty ushort d\n"
                    "property list uint8 float32 weights\nproperty int e\nproperty uint32 f\nproperty float64 x\n"
                    "property float y\nproperty double z\nend_header\n";
  append(out, std::uint8_t{2}, order);
  append(out, std::int16_t{7}, order);
  append(out, std::int16_t{8}, order);
  append(out, 0.5, order);
  append(out, std::int8_t{-5}, order);
  append(out, std::uint8_t{250}, order);
  append(out, std::int16_t{-300}, order);
  append(out, std::uint16_t{65000}, order);
  append(out, std::uint8_t{1}, order);
  append(out, 9.0f, order);
  append(out, std::int32_t{-100000}, order);
  append(out, std::uint32_t{4000000000u}, order);
  append(out, 1.25, order);
  append(out, -2.5f, order);
  append(out, 1e-300, order);
  return out;
}

TEST(Ply, ReadsStripsAndFacesUnderOtherNames) {
  const std::string vertices = "element vertex 5\nproperty float x\nproperty float y\nproperty float z\nelement ";
  const std::string body = "0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 0 0\n";
  const Mesh strips = parse_ply(
      ascii(vertices + "tristrips 1\nproperty list int int vertex_indices\n", body + "8 0 1 2 3 -1 1 4 3\n"), "a.ply");
  Triangles expected(3, 3);
  expected << 0, 2, 1, 1, 1, 4, 2, 3, 3;
  EXPECT_EQ(strips.triangles, expected);
  const Mesh faces = parse_ply(ascii(vertices + "face 1\nproperty list uchar float texcoord\nproperty list uchar int "
                                                "vertex_indexes\n",
                                     body + "2 0 1 3 0 1 2\n"),
                               "a.ply");
  EXPECT_EQ(faces.triangles, expected.leftCols(1));
  EXPECT_FALSE(io_error([&] {
                 parse_ply(ascii(vertices + "tristrips 1\nproperty list int int vertex_indices\n", body + "3 0 1 5\n"),
                           "a.ply");
               }).empty());
}

TEST(Ply, TakesTheUsualSpellingsOfNames) {
  const auto read = [](const std::string& names, const std::string& body) {
    std::string header = "element vertex 1\n";
    std::istringstream words(names);
    for (std::string word; words >> word;) header += "property float " + word + "\n";
    return parse_ply(ascii(header, body), "a.ply");
  };
  for (const char* normal : {"normal_x normal_y normal_z", "normalx normaly normalz", "NX NY NZ"}) {
    const Mesh mesh = read("X Y Z " + std::string(normal), "1 2 3 0 0 1\n");
    EXPECT_EQ(mesh.vertices.col(0), Point<3>(1, 2, 3));
    ASSERT_EQ(mesh.normals.cols(), 1) << normal;
    EXPECT_EQ(mesh.normals.col(0), Point<3>(0, 0, 1));
  }
  for (const char* color : {"r g b", "diffuse_red diffuse_green diffuse_blue"})
    EXPECT_TRUE(find_colors(read("x y z " + std::string(color), "1 2 3 0 0 1\n").properties).complete()) << color;
  const Mesh other = read("x y z r nx ny nz normal_x normal_y normal_z", "1 2 3 7 1 0 0 0 0 1\n");
  EXPECT_EQ(other.properties[0].name, "r");
  EXPECT_EQ(other.normals.col(0), Point<3>(1, 0, 0));
  EXPECT_EQ(other.properties[1].name, "normal_x");
}

TEST(Ply, ColoursOfAnyTypeAreTheSameInOtherFormats) {
  for (const char* values : {"uchar 0 51 255", "ushort 0 13107 65535", "ushort 0 51 255", "float 0 .2 1",
                             "float 0 51 255", "double 0 13107 65535"}) {
    std::istringstream words(values);
    std::string type, r, g, b;
    words >> type >> r >> g >> b;
    std::string header = "element vertex 1\nproperty float x\nproperty float y\nproperty float z\n";
    for (const char* name : {"red", "green", "blue"}) header += "property " + type + " " + name + "\n";
    const Mesh mesh = parse_ply(ascii(header, "1 2 3 " + r + " " + g + " " + b + "\n"), "a.ply");
    EXPECT_EQ(format_obj(mesh), "v 1 2 3 0 0.2 1\n") << values;
    EXPECT_EQ(format_off(mesh), "COFF\n1 0 0\n1 2 3 0 51 255 255\n") << values;
  }
}

TEST(Ply, ReadsEveryScalarTypeInBothByteOrders) {
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    const Mesh mesh = parse_ply(every_type(order), "all.ply");
    EXPECT_EQ(mesh.vertices.col(0), Point<3>(1.25, -2.5, 1e-300));
    const std::vector<std::pair<std::string, double>> expected{{"char", -5},      {"uchar", 250},   {"short", -300},
                                                               {"ushort", 65000}, {"int", -100000}, {"uint", 4e9}};
    ASSERT_EQ(mesh.properties.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      EXPECT_EQ(mesh.properties[i].type, expected[i].first);
      EXPECT_EQ(mesh.properties[i].values(0), expected[i].second);
    }
  }
}

TEST(Ply, ReadsTextWithWindowsLineEndsAndWithoutAFinalNewline) {
  std::string text = ascii(vertex_header, "1 2 3\n\n4 5 nan");
  std::string windows;
  for (const char c : text) windows += c == '\n' ? std::string("\r\n") : std::string(1, c);
  for (const std::string& file : {text, windows}) {
    const Mesh mesh = parse_ply(file, "a.ply");
    EXPECT_EQ(mesh.vertices.col(0), Point<3>(1, 2, 3));
    EXPECT_TRUE(std::isnan(mesh.vertices(2, 1)));
  }
}

TEST(Ply, TurnsPolygonsIntoFans) {
  const std::string elements =
      "element face 2\nproperty uchar flag\nproperty list uchar int vertex_index\nelement vertex 5\nproperty float x\n"
      "property float y\nproperty float z\n";
  const Mesh mesh =
      parse_ply(ascii(elements, "0 5 0 1 2 3 4\n1 3 4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 2 0\n"), "f.ply");
  Triangles expected(3, 4);
  expected << 0, 0, 0, 4, 1, 2, 3, 2, 2, 3, 4, 0;
  EXPECT_EQ(mesh.triangles, expected);
}

TEST(Ply, KeepsNormalsOnlyWhenAllThreeAreThere) {
  const Mesh mesh =
      parse_ply(ascii(vertex_header + "property float nx\nproperty double ny\n", "1 2 3 0 1\n4 5 6 1 0\n"), "n");
  EXPECT_EQ(mesh.normals.cols(), 0);
  ASSERT_EQ(mesh.properties.size(), 2u);
  EXPECT_EQ(mesh.properties[1].name, "ny");
  EXPECT_EQ(mesh.properties[1].type, "double");
}

TEST(Ply, WritesWhatItReads) {
  Mesh mesh;
  mesh.vertices = Points<3>::Random(3, 10).cast<float>().cast<double>();
  mesh.normals = Points<3>::Random(3, 10).cast<float>().cast<double>();
  mesh.triangles.resize(3, 2);
  mesh.triangles << 0, 9, 1, 8, 2, 7;
  mesh.properties = {{"red", "uchar", Eigen::VectorXd::LinSpaced(10, 0, 255).array().round()},
                     {"k1", "double", Eigen::VectorXd::Random(10)},
                     {"label", "short", -Eigen::VectorXd::LinSpaced(10, 0, 9)}};
  const Mesh read = parse_ply(format_ply(mesh), "mesh.ply");
  EXPECT_EQ(read.vertices, mesh.vertices);
  EXPECT_EQ(read.normals, mesh.normals);
  EXPECT_EQ(read.triangles, mesh.triangles);
  ASSERT_EQ(read.properties.size(), mesh.properties.size());
  for (std::size_t i = 0; i < mesh.properties.size(); ++i) {
    EXPECT_EQ(read.properties[i].name, mesh.properties[i].name);
    EXPECT_EQ(read.properties[i].type, mesh.properties[i].type);
    EXPECT_EQ(read.properties[i].values, mesh.properties[i].values);
  }
}

TEST(Ply, SaturatesIntegersItCannotStore) {
  Mesh mesh;
  mesh.vertices = Points<3>::Zero(3, 4);
  mesh.properties = {{"red", "uchar", Eigen::Vector4d(-3, 300, 12.6, std::nan(""))}};
  const Mesh read = parse_ply(format_ply(mesh), "mesh.ply");
  EXPECT_EQ(read.properties[0].values, Eigen::Vector4d(0, 255, 13, 0));
}

TEST(Ply, SaysWhatIsWrongAndInWhichLine) {
  const auto error = [](const std::string& text) { return io_error([&] { parse_ply(text, "b.ply"); }); };
  EXPECT_EQ(error(""), "b.ply: the file is empty");
  EXPECT_EQ(error("solid"), "b.ply:1: not a PLY file: the first line must be \"ply\"");
  EXPECT_EQ(error("ply\nformat ascii 1.0\nelement vertex 3\n"), "b.ply:3: the header has no end_header line");
  EXPECT_EQ(error("ply\nformat zip 1.0\n"),
            "b.ply:2: unknown format \"zip\"; known are ascii, binary_little_endian and binary_big_endian");
  EXPECT_EQ(error("ply\nelement vertex -3\n"), "b.ply:2: \"-3\" is not a number of elements");
  EXPECT_EQ(error("ply\nelement vertex 1\nproperty quad x\n"), "b.ply:3: unknown type \"quad\" in the header");
  EXPECT_EQ(error(ascii("element face 0\nproperty list uchar int vertex_indices\n", "")),
            "b.ply: the file has no vertices");
  EXPECT_EQ(error(ascii("element vertex 1\nproperty float x\nproperty float y\n", "1 2\n")),
            "b.ply: the vertices have no property \"z\"");
  EXPECT_EQ(error(ascii(vertex_header, "1 2 3\n4 5\n")), "b.ply:10: expected 3 coordinates, found 2");
  EXPECT_EQ(error(ascii(vertex_header, "1 2 3 4\n4 5 6\n")), "b.ply:9: expected 3 coordinates, found 4");
  EXPECT_EQ(error(ascii(vertex_header, "1 2 3\n4 five 6\n")), "b.ply:10: \"five\" is not a number");
  EXPECT_EQ(error(ascii(vertex_header, "1.0 2.0 3.0\n")), "b.ply:9: the file ends after 1 of 2 vertex elements");
  const std::string faces = vertex_header + "element face 1\nproperty list uchar int vertex_indices\n";
  EXPECT_EQ(error(ascii(faces, "1 2 3\n4 5 6\n3 0 1 2\n")), "b.ply:13: vertex index 2 is not one of the 2 vertices");
  EXPECT_EQ(error(ascii(faces, "1 2 3\n4 5 6\n3 0 1 nan\n")),
            "b.ply:13: vertex index nan is not one of the 2 vertices");
  EXPECT_EQ(error(ascii(faces, "1 2 3\n4 5 6\n3 0 1\n")),
            "b.ply:13: the line does not match the properties of element face");
  EXPECT_EQ(error(ascii(faces, "1 2 3\n4 5 6\n-1 0 1\n")), "b.ply:13: a list has an impossible length");
}

TEST(Ply, RefusesCountsThatTheFileCannotHold) {
  const std::string huge = "element vertex 2000000000\nproperty float x\nproperty float y\nproperty float z\n";
  EXPECT_EQ(io_error([&] { parse_ply(ascii(huge, "1 2 3\n"), "h.ply"); }),
            "h.ply: the header promises 2000000000 vertex elements, more than the file can hold");
  std::string binary = "ply\nformat binary_little_endian 1.0\n" + huge + "end_header\n" + std::string(25, 'x');
  EXPECT_EQ(io_error([&] { parse_ply(binary, "h.ply"); }),
            "h.ply: the file is truncated: the header promises 2000000000 vertex elements, there is room for 2");
  EXPECT_EQ(io_error([&] { parse_ply(ascii("element vertex 9000000000\nproperty float x\n", ""), "h.ply"); }),
            "h.ply: more than 2^31 - 1 vertices");
  // Elements without properties take no room, whatever their number.
  EXPECT_EQ(parse_ply(ascii("element nothing 9000000000\n" + vertex_header, "1 2 3\n4 5 6\n"), "n.ply").vertices.cols(),
            2);
}

TEST(Ply, WithoutVerticesHasNoPoints) {
  const std::string none = "element vertex 0\nproperty float x\nproperty float y\nproperty float z\n" +
                           std::string("property float nx\nproperty float ny\nproperty float nz\n");
  const Mesh mesh = parse_ply(ascii(none, ""), "n.ply");
  EXPECT_EQ(mesh.vertices.cols(), 0);
  EXPECT_EQ(mesh.normals.cols(), 0);
  EXPECT_TRUE(mesh.properties.empty());
}

TEST(Ply, NamesTheElementWhereABinaryFileEnds) {
  std::string lists = "ply\nformat binary_big_endian 1.0\n" + vertex_header +
                      "element face 2\nproperty list uchar int vertex_indices\nend_header\n";
  lists += std::string(24, '\0');
  lists += std::string{3} + std::string(12, '\0') + std::string{4} + std::string(12, '\0');
  EXPECT_EQ(io_error([&] { parse_ply(lists, "t.ply"); }), "t.ply: face 1: the file ends here");
}

TEST(Ply, SurvivesEveryTruncation) {
  Mesh mesh;
  mesh.vertices = Points<3>::Random(3, 4);
  mesh.triangles = Triangles::Zero(3, 3);
  const std::string whole = format_ply(mesh);
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_THROW(parse_ply(std::string_view(whole).substr(0, size), "t.ply"), IoError) << size;
}

TEST(Ply, HoldsDoublesWhereFloatsWouldMoveCoordinates) {
  const auto holds_doubles = [](const Points<3>& points) {
    Mesh mesh;
    mesh.vertices = points;
    const std::string bytes = format_ply(mesh);
    const bool doubles = bytes.find("property double x\nproperty double y\nproperty double z\n") != std::string::npos;
    const Points<3> read = parse_ply(bytes, "a.ply").vertices;
    const Points<3> expected = doubles ? points : points.cast<float>().cast<double>();
    EXPECT_TRUE(((read.array() == expected.array()) || (read.array().isNaN() && expected.array().isNaN())).all());
    return doubles;
  };
  const Points<3> ball = Points<3>::Random(3, 50);
  const auto at = [&](double x, double y, double z) -> Points<3> { return ball.colwise() + Point<3>(x, y, z); };
  EXPECT_FALSE(holds_doubles(ball));
  EXPECT_FALSE(holds_doubles(at(0, 0, 20)));
  EXPECT_TRUE(holds_doubles(at(500000, 5300000, 300)));
  EXPECT_FALSE(holds_doubles((512 * ball.array()).round() + 500000));  // floats hold them exactly
  EXPECT_TRUE(holds_doubles(ball * 1e300));
  EXPECT_TRUE(holds_doubles(ball * 1e-50));
  EXPECT_FALSE(holds_doubles(Points<3>(3, 0)));
  Points<3> gaps = ball;
  gaps(0, 3) = std::nan("");
  gaps(1, 4) = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(holds_doubles(gaps));
}

}  // namespace
}  // namespace csrbf::ply_test
