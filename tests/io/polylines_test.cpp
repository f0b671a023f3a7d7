#include "csrbf/io/polylines.hpp"

#include "core/error_testing.hpp"
#include "csrbf/io/files/bytes.hpp"
#include "csrbf/io/geometry/formats.hpp"
#include "csrbf/io/points.hpp"
#include "io/io_testing.hpp"

namespace csrbf::polylines_test {
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

// Two squares, the second one within the first.
constexpr const char* squares = "x,y,z,contour\n0,0,1,7\n4,0,1,7\n4,4,1,7\n0,4,1,7\n1,1,1,3\n3,1,1,3\n3,3,1,3\n";

TEST(ReadPolylines, TakesTheContoursOfATable) {
  const TemporaryFolder folder;
  const Polylines lines = read_polylines(folder.with("squares.csv", squares));
  EXPECT_EQ(lines.vertices.cols(), 7);
  EXPECT_EQ(lines.vertices.col(1), Point<3>(4, 0, 1));
  Eigen::Matrix<std::int32_t, 2, Eigen::Dynamic> expected(2, 7);
  expected << 4, 5, 6, 0, 1, 2, 3,  //
      5, 6, 4, 1, 2, 3, 0;
  EXPECT_EQ(lines.edges, expected);
}

TEST(ReadPolylines, KnowsOtherSpellingsOfTheColumn) {
  const TemporaryFolder folder;
  EXPECT_EQ(read_polylines(folder.with("a.txt", "# X Y Z Contour\n0 0 0 1\n1 0 0 1\n1 1 0 1\n")).edges.cols(), 3);
  EXPECT_EQ(read_polylines(folder.with("b.txt", "slice x y z\n1 0 0 0\n1 1 0 0\n1 1 1 0\n")).edges.cols(), 3);
}

TEST(ReadPolylines, TakesTheLinesOfAnObjFile) {
  const TemporaryFolder folder;
  const Polylines lines =
      read_polylines(folder.with("lines.obj", "v 0 0 0\nv 1 0 0\nl 1 2\nv 1 1 0\nv 0 1 0\nl 2/5 -2 -1 1\n"));
  Eigen::Matrix<std::int32_t, 2, Eigen::Dynamic> expected(2, 4);
  expected << 0, 1, 2, 3,  //
      1, 2, 3, 0;
  EXPECT_EQ(lines.edges, expected);
  EXPECT_EQ(lines.vertices.col(3), Point<3>(0, 1, 0));
}

TEST(ReadPolylines, ReadsWhatWasWritten) {
  const TemporaryFolder folder;
  const Polylines lines = triangle();
  write_polylines(folder.file("lines.ply"), lines);
  const Polylines read = read_polylines(folder.file("lines.ply"));
  EXPECT_EQ(read.vertices, lines.vertices.cast<float>().cast<double>());
  EXPECT_EQ(read.edges, lines.edges);
  ASSERT_EQ(read.properties.size(), 1U);
  EXPECT_EQ(read.properties[0].values, lines.properties[0].values);
}

TEST(ReadPolylines, SaysWhereAFileIsWrong) {
  const TemporaryFolder folder;
  const auto error = [&](const std::string& name, const std::string& text) {
    const std::string message = io_error([&] { read_polylines(folder.with(name, text)); });
    return message.substr(std::min(message.size(), folder.folder().size() + 1));
  };
  EXPECT_EQ(error("a.csv", "x,y,z\n1,2,3\n"),
            "a.csv: no column is named \"contour\"; name the columns in the first line: x,y,z,contour");
  EXPECT_EQ(error("a.csv", "x,y,z,contour\n1,2,3,one\n"), "a.csv:2: \"one\" is not a number");
  EXPECT_EQ(error("a.csv", "x,y,z,contour\n1,2,3,1\n1,2,4,nan\n"), "a.csv: point 2 has no contour");
  EXPECT_EQ(error("a.obj", "v 1 2 3\nl 1\n"), "a.obj:2: line 1 has 1 vertices");
  EXPECT_EQ(error("a.obj", "v 1 2 3\nl 1 2\n"), "a.obj:2: line 1: vertex index 2 is not one of the 1 before it");
  EXPECT_EQ(error("a.obj", "v 1 2 3\n"), "a.obj: the file holds 1 points but no curves");
  EXPECT_EQ(error("a.stl", ""),
            "a.stl: unknown extension \".stl\"; files of curves are .csv .txt .xyz .pts .obj .ply .vtp");
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nelement edge 1\n"
      "property int vertex1\nproperty int vertex2\nend_header\n0 0 0\n1 0 0\n0 2\n";
  EXPECT_EQ(error("a.ply", ply), "a.ply:13: vertex index 2 is not one of the 2 vertices");
}

TEST(ReadPointsOrPolylines, TellsCurvesFromPointsAndSurfaces) {
  const TemporaryFolder folder;
  const auto holds_polylines = [](const std::string& path) {
    return std::holds_alternative<Polylines>(read_points_or_polylines(path));
  };
  write_polylines(folder.file("lines.ply"), triangle());
  EXPECT_TRUE(holds_polylines(folder.file("lines.ply")));
  EXPECT_TRUE(holds_polylines(folder.with("a.csv", squares)));
  EXPECT_TRUE(holds_polylines(folder.with("a.txt", "# drawn by hand\n# x y z contour\n0 0 0 1\n")));
  EXPECT_TRUE(holds_polylines(folder.with("a.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n")));
  EXPECT_FALSE(holds_polylines(folder.with("b.csv", "x,y,z,contours\n0,0,0,1\n")));
  EXPECT_FALSE(holds_polylines(folder.with("b.txt", "0 0 0\n# contour\n")));
  EXPECT_FALSE(holds_polylines(folder.with("b.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nl 1 2\nf 1 2 3\n")));
  EXPECT_FALSE(holds_polylines(folder.with("b.off", "OFF\n1 0 0\n0 0 0\n")));
}

TEST(ReadPointsOrPolylines, ReadsWhatTheOtherReadersRead) {
  const TemporaryFolder folder;
  const std::string curves = folder.with("a.csv", squares), points = folder.with("b.xyz", "0 0 0\n1 2 3\n");
  EXPECT_EQ(std::get<Polylines>(read_points_or_polylines(curves)).edges, read_polylines(curves).edges);
  EXPECT_EQ(std::get<Mesh>(read_points_or_polylines(points)).vertices, read_points(points).points);
}

TEST(ReadPointsOrPolylines, SaysAsReadPointsWhatIsWrong) {
  const TemporaryFolder folder;
  for (const std::string& path : {folder.with("b.ply", "no ply"), folder.with("b.npy", "contour"),
                                  folder.file("missing.csv"), folder.file("missing.abc")}) {
    const std::string message = io_error([&] { read_points_or_polylines(path); });
    EXPECT_EQ(message, io_error([&] { read_points(path); }));
    EXPECT_NE(message, "") << path;
  }
}

}  // namespace
}  // namespace csrbf::polylines_test
