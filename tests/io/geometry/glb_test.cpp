#include "csrbf/io/files/bytes.hpp"
#include "csrbf/io/geometry/formats.hpp"

#include "io/io_testing.hpp"

namespace csrbf::glb_test {
namespace {

using testing::io_error;

Mesh triangle() {
  Mesh mesh;
  mesh.vertices.resize(3, 3);
  mesh.vertices << 0, 1, 0, 0, 0, 2, 0, 0, 3;
  mesh.triangles.resize(3, 1);
  mesh.triangles << 0, 1, 2;
  return mesh;
}

struct Glb {
  std::string json, binary;
};

// The two chunks, whose sizes must add up.
Glb chunks(const std::string& bytes) {
  const auto word = [&](std::size_t at) { return load_scalar<std::uint32_t>(bytes.data() + at); };
  EXPECT_EQ(bytes.substr(0, 4), "glTF");
  EXPECT_EQ(word(4), 2U);
  EXPECT_EQ(word(8), bytes.size());
  const std::size_t json = word(12), binary = word(20 + json);
  EXPECT_EQ(json % 4, 0U);
  EXPECT_EQ(binary % 4, 0U);
  EXPECT_EQ(bytes.substr(16, 4), "JSON");
  EXPECT_EQ(bytes.substr(24 + json, 4), std::string("BIN\0", 4));
  EXPECT_EQ(28 + json + binary, bytes.size());
  return {bytes.substr(20, json), bytes.substr(28 + json)};
}

TEST(Glb, HasVerticesAndTriangles) {
  const auto [json, binary] = chunks(format_glb(triangle()));
  ASSERT_EQ(binary.size(), 9 * 4 + 3 * 4U);
  EXPECT_EQ(load_scalar<float>(binary.data() + 8 * 4), 3);
  EXPECT_EQ(load_scalar<std::uint32_t>(binary.data() + 9 * 4 + 2 * 4), 2U);
  EXPECT_NE(json.find(R"("min":[0,0,0],"max":[1,2,3])"), std::string::npos);
  EXPECT_NE(json.find(R"("indices":1)"), std::string::npos);
  EXPECT_EQ(json.find("translation"), std::string::npos);
}

TEST(Glb, HasUnitNormalsAndLinearColors) {
  Mesh mesh = triangle();
  mesh.normals = Points<3>::Zero(3, 3);
  mesh.normals.row(0).setConstant(5);
  for (const char* name : {"red", "green", "blue"})
    mesh.properties.push_back({name, "uchar", Eigen::VectorXd::Constant(3, name[0] == 'r' ? 255 : 128)});
  const auto [json, binary] = chunks(format_glb(mesh));
  ASSERT_EQ(binary.size(), 2 * 9 * 4 + 3 * 8 + 3 * 4U);
  EXPECT_EQ(load_scalar<float>(binary.data() + 9 * 4), 1);
  const char* color = binary.data() + 2 * 9 * 4;
  EXPECT_EQ(load_scalar<std::uint16_t>(color), 65535);
  EXPECT_NEAR(load_scalar<std::uint16_t>(color + 2), 0.21586 * 65535, 1);  // 128 of sRGB
  EXPECT_NE(json.find(R"("COLOR_0":2)"), std::string::npos);
}

TEST(Glb, KeepsDigitsFarFromTheOriginAndHoldsPoints) {
  Mesh mesh = triangle();
  mesh.vertices.colwise() += Point<3>(500000, 4650000.25, 0);
  mesh.triangles.resize(3, 0);
  const auto [json, binary] = chunks(format_glb(mesh));
  EXPECT_NE(json.find(R"("translation":[500000.5,4650001.25,1.5])"), std::string::npos);
  EXPECT_NE(json.find(R"("mode":0)"), std::string::npos);
  EXPECT_EQ(load_scalar<float>(binary.data()), -.5F);
}

TEST(Glb, NeedsFiniteVertices) {
  EXPECT_NE(io_error([] { format_glb(Mesh{}); }).find("needs a vertex"), std::string::npos);
  Mesh mesh = triangle();
  mesh.vertices(0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(io_error([&] { format_glb(mesh); }).find("finite"), std::string::npos);
}

}  // namespace
}  // namespace csrbf::glb_test
