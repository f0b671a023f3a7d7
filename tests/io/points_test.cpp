#include "csrbf/io/points.hpp"

#include "csrbf/io/files/bytes.hpp"
#include "csrbf/io/files/npy.hpp"

#include "io/io_testing.hpp"

namespace csrbf::points_test {
namespace {

using testing::content;
using testing::io_error;
using testing::TemporaryFolder;

Points<3> two_points() {
  Points<3> p(3, 2);
  p << 1, 4, 2, 5, 3, 6;
  return p;
}

const Property* find(const PointCloud& cloud, const std::string& name) {
  for (const Property& p : cloud.properties)
    if (p.name == name) return &p;
  return nullptr;
}

TEST(ReadPoints, UnderstandsTheUsualLayoutsOfTextFiles) {
  const TemporaryFolder folder;
  const std::vector<std::pair<std::string, std::string>> files{
      {"blanks.xyz", "1 2 3\n4 5 6\n"},
      {"tabs.txt", "1\t2\t3\r\n4\t5\t6\r\n"},
      {"comma.csv", "1,2,3\n4,5,6"},
      {"semicolon.csv", " 1 ; 2 ; 3 \n4;5;+6;\n"},
      {"comments.xyz", "# a cloud of two points\n1 2 3 # first\n\n4 5 6\n"},
      {"header.csv", "\xEF\xBB\xBF\"z\",\"X\",y\n3,1,2\n6,4,5\n"},
      {"named.txt", "//Z X Y\n3 1 2\n6 4 5\n"},
      {"count.pts", "2\n1 2 3\n4 5 6\n"},
      {"exponent.xyz", "1e0 2.0 .3E1\n4. 5 6\n"}};
  for (const auto& [name, text] : files) EXPECT_EQ(read_points(folder.with(name, text)).points, two_points()) << name;
}

TEST(ReadPoints, TakesQuotedCells) {
  const TemporaryFolder folder;
  for (const char* text :
       {"\"1\",\"2\",\"3\"\n\"4\",\"5\",\"6\"\n", "\"x\",\"y\",\"z\"\r\n\"1\" , 2, \" 3\"\r\n4,\"5\",6,\r\n",
        "\"x\" \"y\" \"z\"\n\"1\" 2 \"3\"\n4 5 6\n"})
    EXPECT_EQ(read_points(folder.with("a.csv", text)).points, two_points()) << text;
  const PointCloud cloud = read_points(folder.with("a.csv", "x,y,z,\"height, \"\"m\"\"\"\n1,2,3,7\n4,5,6,8\n"));
  EXPECT_EQ(cloud.points, two_points());
  ASSERT_EQ(cloud.properties.size(), 1u);
  EXPECT_EQ(cloud.properties[0].name, "height, \"m\"");
}

TEST(ReadPoints, ReadsTheLineEndsOfOldMacs) {
  const TemporaryFolder folder;
  EXPECT_EQ(read_points(folder.with("a.csv", "x,y,z\r1,2,3\r4,5,6\r")).points, two_points());
}

TEST(ReadPoints, ReadsDecimalCommasBetweenSemicolons) {
  const TemporaryFolder folder;
  Points<3> expected(3, 2);
  expected << 511822.5, 2, -.5, .25, 7, 1e3;
  for (const std::string head : {"", "x;y;z\n"})
    EXPECT_EQ(read_points(folder.with("a.csv", head + "511822,5;-0,5;7\n2,0;,25;1,0e3\n")).points, expected) << head;
  const auto error = [&](const std::string& text) {
    const std::string path = folder.with("e.csv", text);
    return io_error([&] { read_points(path); }).substr(path.size());
  };
  // Not if others have a point, and not if they may separate thousands.
  EXPECT_NE(error("0.5;1;2\n0,5;1;2\n").find("has decimal commas; write numbers with a point"), std::string::npos);
  EXPECT_NE(error("1;980;2\n1;1,176;2\n").find("has decimal commas; write numbers with a point"), std::string::npos);
  EXPECT_NE(error("1,5;980;2\n2,5;1,176;2\n").find(":2: \"2,5;1,176;2\" has decimal commas"), std::string::npos);
  EXPECT_NE(error("1,5;1;2,5,5\n").find("\"2,5,5\" is not a number"), std::string::npos);
}

TEST(ReadPoints, NamesDecimalCommasAndUtf16) {
  const TemporaryFolder folder;
  const auto error = [&](const std::string& text) {
    const std::string path = folder.with("e.csv", text);
    return io_error([&] { read_points(path); }).substr(path.size());
  };
  EXPECT_EQ(error("0,14 0,51 1,2\n"), ":1: \"0,14 0,51 1,2\" has decimal commas; write numbers with a point, as 0.5");
  for (const char* row : {"x y z\n0,14 0,51 1,2\n", "1 2 3\n511822,5\t4112,25\t1,0\n"})
    EXPECT_NE(error(row).find("has decimal commas"), std::string::npos) << row;
  EXPECT_NE(error("511822,5\t4112,25\t1,0\n").find("has decimal commas"), std::string::npos);
  EXPECT_EQ(error(std::string("\xFF\xFE"
                              "1\0,\0",
                              6)),
            ": the text is UTF-16; save it as UTF-8");
  EXPECT_EQ(error(std::string("1\0,\0", 4)), ": the text is UTF-16; save it as UTF-8");
}

TEST(ReadPoints, TellsNormalsFromColours) {
  const TemporaryFolder folder;
  const PointCloud normals = read_points(folder.with("n.xyz", "1 2 3 0 0 1\n4 5 6 1 0 0\n"));
  ASSERT_TRUE(normals.has_normals());
  EXPECT_EQ(normals.normals.col(1), Point<3>(1, 0, 0));
  const PointCloud colors = read_points(folder.with("c.xyz", "1 2 3 0 0 255\n4 5 6 17 0 0\n"));
  EXPECT_FALSE(colors.has_normals());
  ASSERT_NE(find(colors, "red"), nullptr);
  EXPECT_EQ(find(colors, "red")->values, Eigen::Vector2d(0, 17));
  EXPECT_EQ(find(colors, "red")->type, "uchar");
  const PointCloud scan = read_points(folder.with("s.pts", "2\n1 2 3 -100 0 0 255\n4 5 6 -200 17 0 0\n"));
  ASSERT_NE(find(scan, "intensity"), nullptr);
  EXPECT_EQ(find(scan, "intensity")->values, Eigen::Vector2d(-100, -200));
  EXPECT_EQ(find(scan, "blue")->values, Eigen::Vector2d(255, 0));
}

TEST(ReadPoints, FindsUnitNormalsAmongMoreColumns) {
  const TemporaryFolder folder;
  const PointCloud curved = read_points(folder.with("c.xyz", "1 2 3 0 -1 0 .25\n4 5 6 .6 0 -.8 .5\n"));
  ASSERT_TRUE(curved.has_normals());
  EXPECT_EQ(curved.normals.col(1), Point<3>(.6, 0, -.8));
  const PointCloud last = read_points(folder.with("l.xyz", "1 2 3 9 8 7 6 0 -1 0\n4 5 6 6 7 8 9 .6 0 -.8\n"));
  ASSERT_TRUE(last.has_normals());
  EXPECT_EQ(last.normals.col(0), Point<3>(0, -1, 0));
  EXPECT_EQ(std::ssize(last.properties), 4);
  EXPECT_FALSE(read_points(folder.with("n.xyz", "1 2 3 .1 .2 .3 .4\n4 5 6 .6 .5 .4 .3\n")).has_normals());
  EXPECT_FALSE(read_points(folder.with("n.xyz", "1 2 3 1 0 0 .4\n4 5 6 0 1 0 .3\n")).has_normals());
}

TEST(ReadPoints, KeepsColoursOf16Bits) {
  const TemporaryFolder folder;
  for (const char* text :
       {"x y z r g b\n1 2 3 0 257 65535\n4 5 6 25700 0 0\n", "1 2 3 0 257 65535\n4 5 6 25700 0 0\n"}) {
    const PointCloud cloud = read_points(folder.with("c.txt", text));
    ASSERT_NE(find(cloud, "green"), nullptr) << text;
    EXPECT_EQ(find(cloud, "red")->values, Eigen::Vector2d(0, 100));
    EXPECT_EQ(find(cloud, "blue")->values, Eigen::Vector2d(255, 0));
  }
  const PointCloud gaps = read_points(folder.with("g.txt", "x y z r g b\n1 2 3 nan 2 3\n4 5 6 10 20 30\n"));
  EXPECT_EQ(find(gaps, "green")->values, Eigen::Vector2d(2, 20));
}

TEST(ReadPoints, TakesColumnsByName) {
  const TemporaryFolder folder;
  const PointCloud cloud =
      read_points(folder.with("all.csv", "id,nx,ny,nz,x,y,z,r,g,b\n7,0,0,1,1,2,3,10,20,30\n8,0,1,0,4,5,6,40,50,60\n"));
  EXPECT_EQ(cloud.points, two_points());
  EXPECT_EQ(cloud.normals.col(0), Point<3>(0, 0, 1));
  EXPECT_EQ(find(cloud, "green")->values, Eigen::Vector2d(20, 50));
  EXPECT_EQ(find(cloud, "id")->values, Eigen::Vector2d(7, 8));
}

TEST(ReadPoints, ReadsVerticesNormalsAndColoursOfObjAndOff) {
  const TemporaryFolder folder;
  const PointCloud obj =
      read_points(folder.with("a.obj", "# x\nv 1 2 3 1 0 0\nv 4 5 6 0 0.2 1\nvn 0 0 1\nvn 0 1 0\nusemtl red\n"));
  EXPECT_EQ(obj.points, two_points());
  EXPECT_EQ(obj.normals.col(1), Point<3>(0, 1, 0));
  EXPECT_EQ(find(obj, "green")->values, Eigen::Vector2d(0, 51));
  const PointCloud off = read_points(folder.with("a.off", "CNOFF\n2 0 0\n1 2 3 0 0 1 9 8 7 255\n4 5 6 0 1 0 1 2 3\n"));
  EXPECT_EQ(off.points, two_points());
  EXPECT_EQ(off.normals.col(1), Point<3>(0, 1, 0));
  EXPECT_EQ(find(off, "blue")->values, Eigen::Vector2d(7, 3));
  EXPECT_EQ(read_points(folder.with("b.off", "OFF2 0 0 # counts\n1 2 3\n4 5 6\n")).points, two_points());
}

TEST(ReadPoints, ReadsArraysOfEveryLayout) {
  const TemporaryFolder folder;
  const auto npy = [](const std::string& descr, const std::string& order, char version, auto scalars,
                      std::endian endian) {
    std::string header = "{'descr': '" + descr + "', 'fortran_order': " + order + ", 'shape': (2, 3), }\n";
    std::string out("\x93NUMPY");
    out += {version, '\0'};
    if (version == 1)
      append_scalar(out, static_cast<std::uint16_t>(header.size()));
    else
      append_scalar(out, static_cast<std::uint32_t>(header.size()));
    out += header;
    for (const auto value : scalars) {
      std::string bytes;
      append_scalar(bytes, value);
      if (endian == std::endian::big) std::reverse(bytes.begin(), bytes.end());
      out += bytes;
    }
    return out;
  };
  const std::vector<double> c_order{1, 2, 3, 4, 5, 6};
  const std::vector<double> fortran{1, 4, 2, 5, 3, 6};
  const std::vector<float> floats{1, 2, 3, 4, 5, 6};
  const std::vector<std::int16_t> shorts{1, 2, 3, 4, 5, 6};
  const std::vector<std::string> files{
      npy("<f8", "False", 1, c_order, std::endian::little), npy(">f8", "False", 2, c_order, std::endian::big),
      npy("<f8", "True", 2, fortran, std::endian::little), npy("<f4", "False", 1, floats, std::endian::little),
      npy(">i2", "False", 3, shorts, std::endian::big)};
  for (const std::string& file : files) EXPECT_EQ(read_points(folder.with("a.npy", file)).points, two_points());
}

TEST(WritePoints, WritesWhatReadPointsReads) {
  const TemporaryFolder folder;
  PointCloud cloud;
  cloud.points = Points<3>::Random(3, 20).cast<float>().cast<double>();
  cloud.normals = Points<3>::Random(3, 20).cast<float>().cast<double>();
  for (const char* name : {"red", "green", "blue"})
    cloud.properties.push_back({name, "uchar", Eigen::VectorXd::LinSpaced(20, 0, 255).array().round()});
  cloud.properties.push_back({"quality", "float", Eigen::VectorXd::Random(20).cast<float>().cast<double>()});
  const std::vector<std::pair<std::string, std::size_t>> kept{{"a.ply", 4}, {"a.csv", 4}, {"a.txt", 4}, {"a.obj", 3},
                                                              {"a.off", 3}, {"a.xyz", 0}, {"a.pts", 0}, {"a.npy", 0}};
  for (const auto& [name, properties] : kept) {
    write_points(folder.file(name), cloud);
    const PointCloud read = read_points(folder.file(name));
    EXPECT_EQ(read.points, cloud.points) << name;
    EXPECT_EQ(read.normals, cloud.normals) << name;
    ASSERT_EQ(read.properties.size(), properties) << name;
    for (std::size_t i = 0; i < properties; ++i)
      EXPECT_EQ(read.properties[i].values, cloud.properties[i].values) << name;
  }
  EXPECT_EQ(folder.files(), 8);
}

TEST(WritePoints, TellsWhatTheFormatHasNoPlaceFor) {
  const TemporaryFolder folder;
  const PointCloud cloud =
      read_points(folder.with("a.csv", "x,y,z,r,g,b,intensity\n1,2,3,10,20,30,7\n4,5,6,40,50,60,8\n"));
  const auto warning = [&](const std::string& name) {
    const std::vector<std::string> warnings = write_points(folder.file(name), cloud);
    return warnings.empty() ? "" : warnings[0].substr(folder.file("").size());
  };
  for (const char* name : {"b.ply", "b.vtp", "b.csv", "b.txt"}) EXPECT_EQ(warning(name), "");
  EXPECT_EQ(warning("b.xyz"),
            "b.xyz: .xyz has no place for red, green, blue, intensity; .ply, .vtp, .csv and .txt have");
  EXPECT_EQ(warning("b.obj"), "b.obj: .obj has no place for intensity; .ply, .vtp, .csv and .txt have");
}

TEST(WritePoints, KeepsDoublesExactlyInTextAndArrays) {
  const TemporaryFolder folder;
  PointCloud cloud;
  cloud.points = Points<3>::Random(3, 50) * 1e-30;
  for (const char* name : {"a.xyz", "a.csv", "a.obj", "a.off", "a.npy"}) {
    write_points(folder.file(name), cloud);
    EXPECT_EQ(read_points(folder.file(name)).points, cloud.points) << name;
  }
}

TEST(WritePoints, SavesArraysAsNumPyDoes) {
  EXPECT_EQ(io_error([] {
              parse_npy(format_npy({{}, {}}), "scalar.npy");
            }),
            "scalar.npy: the file is truncated: it holds 0 elements");
  const std::string bytes = format_npy({{1, 2}, {1.5, -2}});
  EXPECT_EQ(bytes.size() % 64, 16u);  // a header that is a multiple of 64 bytes long, two doubles
  EXPECT_EQ(bytes.substr(0, 10), std::string("\x93NUMPY\x01\x00\x76\x00", 10));
  EXPECT_TRUE(bytes.substr(10).starts_with("{'descr': '<f8', 'fortran_order': False, 'shape': (1, 2), }"));
}

TEST(ReadPoints, SaysWhatIsWrongAndInWhichLine) {
  const TemporaryFolder folder;
  const auto error = [&](const std::string& name, const std::string& text) {
    const std::string path = folder.with(name, text);
    const std::string message = io_error([&] { read_points(path); });
    return message.starts_with(path) ? message.substr(folder.folder().size() + 1) : message;
  };
  EXPECT_EQ(error("e.xyz", ""), "e.xyz: the file holds no rows of numbers");
  EXPECT_EQ(error("e.xyz", "# nothing\n\n"), "e.xyz: the file holds no rows of numbers");
  EXPECT_EQ(error("e.xyz", "x y z\n"), "e.xyz: the file holds column names but no rows of numbers");
  EXPECT_EQ(error("e.xyz", "1 2\n3 4\n"), "e.xyz:1: expected 3 coordinates, found 2");
  EXPECT_EQ(error("e.xyz", "1 2 3\n\n4 5\n"), "e.xyz:3: expected 3 columns as in line 1, found 2");
  EXPECT_EQ(error("e.xyz", "1 2 3\n4 5 6 7\n"), "e.xyz:2: expected 3 columns as in line 1, found 4");
  EXPECT_EQ(error("e.xyz", "1 2 3\n4 x 6\n"), "e.xyz:2: \"x\" is not a number");
  EXPECT_EQ(error("e.xyz", "1 2 3\n4 5 6f\n"), "e.xyz:2: \"6f\" is not a number");
  EXPECT_EQ(error("e.csv", "1,2,3\n4,,6\n"), "e.csv:2: cell 2 is empty");
  EXPECT_EQ(error("e.csv", "x,y,w\n1,2,3\n"),
            "e.csv: no column is named \"z\"; the columns are \"x\", \"y\", \"w\": rename those of the coordinates to "
            "x, y and z");
  EXPECT_EQ(error("e.csv", "x,y,z\n1,2\n"), "e.csv:2: expected 3 columns as named, found 2");
  EXPECT_EQ(error("e.pts", "3\n1 2 3\n4 5 6\n"), "e.pts: the first line promises 3 rows, found 2");
  EXPECT_EQ(error("e.obj", "v 1 2\n"), "e.obj:1: expected 3 coordinates, found 2");
  EXPECT_EQ(error("e.obj", "o thing\n"), "e.obj: the file has no vertices");
  EXPECT_EQ(error("e.off", "OFF\n3 0 0\n1 2 3\n4 5 6\n"), "e.off:4: the file ends after 2 of 3 vertices");
  EXPECT_EQ(error("e.off", "OFF\n2000000000 0 0\n1 2 3\n4 5 6\n"),
            "e.off:2: the counts promise more than the file can hold");
  EXPECT_EQ(error("e.off", "OFF\n2 0 0\n1 2 3\n4 5\n"), "e.off:4: expected 3 coordinates, found 2");
  EXPECT_EQ(error("e.off", "OFF\n-2 0 0\n"), "e.off:2: \"-2\" is not a number of vertices");
  EXPECT_EQ(error("e.off", "4OFF\n1 0 0\n1 2 3 4\n"),
            "e.off:1: not an OFF file of 3D points: the first line must begin with OFF, COFF, NOFF or CNOFF");
  EXPECT_EQ(error("e.npy", format_npy({{2, 2}, {1, 2, 3, 4}})),
            "e.npy: the array has shape (2, 2), points need (n, 3), or (n, 6) with normals");
  EXPECT_EQ(error("e.npy", format_npy({{2, 3}, {1, 2, 3, 4}})), "e.npy: the file is truncated: it holds 4 elements");
  EXPECT_EQ(error("e.npy", format_npy({{Index{1} << 62, Index{1} << 62}, {1}})),
            "e.npy: the file is truncated: it holds 1 elements");
  EXPECT_EQ(error("e.npy", "numpy"), "e.npy: not a .npy file");
}

TEST(ReadPoints, SaysWhyAFileCannotBeOpened) {
  const TemporaryFolder folder;
  const std::string missing = folder.file("missing.xyz");
  EXPECT_EQ(io_error([&] { read_points(missing); }), missing + ": cannot read the file: No such file or directory");
  std::filesystem::create_directory(folder.file("folder.ply"));
  EXPECT_EQ(io_error([&] { read_points(folder.file("folder.ply")); }),
            folder.file("folder.ply") + ": cannot read the file: Is a directory");
  EXPECT_EQ(io_error([&] { read_points("cloud.shp"); }),
            "cloud.shp: unknown extension \".shp\"; point files are .ply .xyz .pts .txt .csv .obj .off .npy .vtp .stl "
            ".las .laz .e57 .pcd .ptx");
  EXPECT_EQ(io_error([&] { write_points("cloud", {}); }),
            "cloud: unknown extension \"\"; point files are .ply .xyz .pts .txt .csv .obj .off .npy .vtp, also as .gz");
}

}  // namespace
}  // namespace csrbf::points_test
