#include "csrbf/io/polylines.hpp"

#include "core/error_testing.hpp"
#include "csrbf/io/bytes.hpp"
#include "csrbf/io/ply.hpp"
#include "io_testing.hpp"

namespace csrbf {
namespace {

using testing::content;
using testing::io_error;
using testing::TemporaryFolder;

Polylines triangle() {
  Polylines lines;
  lines.vertices = Points<3>::Random(3, 3);
  lines.edges.resize(2, 3);
  lines.edges << 0, 1, 2, 1, 2, 0;
  lines.properties = {{"kind", "char", Eigen::Vector3d(1, -1, 1)}};
  return lines;
}

TEST(Polylines, AreVerticesWithPropertiesAndEdges) {
  const TemporaryFolder folder;
  const Polylines lines = triangle();
  write_polylines(folder.file("lines.ply"), lines);
  const std::string bytes = content(folder.file("lines.ply"));
  EXPECT_NE(bytes.find("element edge 3\nproperty int vertex1\nproperty int vertex2\nend_header\n"), std::string::npos);
  for (Index i = 0; i < 6; ++i)
    EXPECT_EQ(load_scalar<std::int32_t>(bytes.data() + bytes.size() - 24 + 4 * i), lines.edges.data()[i]);
  const Mesh read = parse_ply(bytes, "lines.ply");
  EXPECT_EQ(read.vertices, lines.vertices.cast<float>().cast<double>());
  ASSERT_EQ(read.properties.size(), 1U);
  EXPECT_EQ(read.properties[0].name, "kind");
  EXPECT_EQ(read.properties[0].type, "char");
  EXPECT_EQ(read.properties[0].values, lines.properties[0].values);
}

TEST(Polylines, MayBeNone) {
  const TemporaryFolder folder;
  write_polylines(folder.file("none.ply"), {});
  EXPECT_EQ(parse_ply(content(folder.file("none.ply")), "none.ply").vertices.cols(), 0);
}

TEST(Polylines, AreOnlyWrittenWhenValidAndAsPly) {
  const TemporaryFolder folder;
  EXPECT_NE(io_error([&] { write_polylines(folder.file("lines.obj"), triangle()); }).find("files of curves are .ply"),
            std::string::npos);
  Polylines broken = triangle();
  broken.edges(1, 2) = 3;
  EXPECT_NE(invalid_input_message([&] { write_polylines(folder.file("lines.ply"), broken); }).find("vertex index"),
            std::string::npos);
  EXPECT_EQ(folder.files(), 0);
}

}  // namespace
}  // namespace csrbf
