#include "csrbf/io/geometry/formats.hpp"
#include "csrbf/io/points.hpp"

#include "io/io_testing.hpp"

#ifdef CSRBF_HAS_E57
#include <E57Format.h>
#endif

namespace csrbf::e57_test {
namespace {

using testing::io_error;
using testing::TemporaryFolder;

std::string error(const std::string& bytes) {
  return io_error([&] { parse_e57(bytes, "a.e57"); });
}

#ifndef CSRBF_HAS_E57

TEST(E57, OfABuildWithoutTheLibrarySaysWhatToDo) {
  EXPECT_FALSE(reads_e57());
  EXPECT_NE(error("ply").find("a.e57: not an E57 file"), std::string::npos);
  EXPECT_NE(error("ASTM-E57").find("convert the file to .las or .ply"), std::string::npos);
}

#else

// A file of one cartesian scan of three points, the second of which is invalid, turned by 90 degrees about z and moved
// by (100, 0, 0), with 16-bit colours; and of one spherical scan of one point, without a pose.
void write_e57(const std::string& path) {
  e57::ImageFile file(path, "w");
  e57::StructureNode root = file.root();
  root.set("formatName", e57::StringNode(file, "ASTM E57 3D Imaging Data File"));
  root.set("guid", e57::StringNode(file, "csrbf"));
  root.set("versionMajor", e57::IntegerNode(file, 1));
  root.set("versionMinor", e57::IntegerNode(file, 0));
  const e57::VectorNode scans(file, true);
  root.set("data3D", scans);
  const auto add_scan = [&](e57::StructureNode scan, const std::vector<std::string>& names,
                            std::vector<std::vector<double> > values) {
    e57::VectorNode(scans).append(scan);
    e57::StructureNode prototype(file);
    for (const std::string& name : names) {
      if (name == "cartesianInvalidState")
        prototype.set(name, e57::IntegerNode(file, 0, 0, 2));
      else if (name.starts_with("color"))
        prototype.set(name, e57::IntegerNode(file, 0, 0, 65535));
      else if (name == "cartesianX")
        prototype.set(name, e57::ScaledIntegerNode(file, 0, -1000000, 1000000, .001, 0.));
      else
        prototype.set(name, e57::FloatNode(file));
    }
    e57::CompressedVectorNode points(file, prototype, e57::VectorNode(file, true));
    scan.set("points", points);
    std::vector<e57::SourceDestBuffer> sources;
    for (std::size_t c = 0; c < names.size(); ++c)
      sources.emplace_back(file, names[c], values[c].data(), values[c].size(), true, names[c] == "cartesianX");
    e57::CompressedVectorWriter writer = points.writer(sources);
    writer.write(values[0].size());
    writer.close();
  };

  const e57::StructureNode first(file);
  e57::StructureNode pose(file), rotation(file), translation(file);
  rotation.set("w", e57::FloatNode(file, std::sqrt(.5)));
  rotation.set("x", e57::FloatNode(file));
  rotation.set("y", e57::FloatNode(file));
  rotation.set("z", e57::FloatNode(file, std::sqrt(.5)));
  translation.set("x", e57::FloatNode(file, 100));
  translation.set("y", e57::FloatNode(file));
  translation.set("z", e57::IntegerNode(file, 0));  // as some programs write whole numbers
  pose.set("rotation", rotation);
  pose.set("translation", translation);
  e57::StructureNode(first).set("pose", pose);
  add_scan(first,
           {"cartesianX", "cartesianY", "cartesianZ", "cartesianInvalidState", "colorRed", "colorGreen", "colorBlue",
            "intensity"},
           {{1.5, 7, 2}, {2, 7, 0}, {3, 7, 1}, {0, 2, 0}, {0, 0, 65535}, {257, 0, 514}, {0, 0, 0}, {.25, 0, .5}});
  add_scan(e57::StructureNode(file), {"sphericalRange", "sphericalAzimuth", "sphericalElevation"},
           {{2}, {std::acos(0.)}, {0}});
  file.close();
}

class E57 : public ::testing::Test {
 protected:
  void SetUp() override { write_e57(folder.file("a.e57")); }

  [[nodiscard]] std::string bytes() const {
    std::ifstream file(folder.file("a.e57"), std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  TemporaryFolder folder;
};

TEST_F(E57, HasTheValidPointsOfAllScansInTheirCommonPlace) {
  EXPECT_TRUE(reads_e57());
  const PointCloud cloud = read_points(folder.file("a.e57"));
  ASSERT_EQ(cloud.size(), 3);
  EXPECT_TRUE(cloud.points.col(0).isApprox(Point<3>(98, 1.5, 3), 1e-12)) << cloud.points;
  EXPECT_TRUE(cloud.points.col(1).isApprox(Point<3>(100, 2, 1), 1e-12)) << cloud.points;
  EXPECT_TRUE(cloud.points.col(2).isApprox(Point<3>(0, 2, 0), 1e-12)) << cloud.points;
}

TEST_F(E57, HasIntensityAndColoursOfABytePerChannel) {
  const PointCloud cloud = read_points(folder.file("a.e57"));
  const auto values = [&](const std::string& name) {
    for (const Property& p : cloud.properties)
      if (p.name == name) return p.values;
    return Eigen::VectorXd();
  };
  EXPECT_EQ(values("intensity"), Eigen::Vector3d(.25, .5, 0));
  EXPECT_EQ(values("red"), Eigen::Vector3d(0, 255, 0));
  EXPECT_EQ(values("green"), Eigen::Vector3d(1, 2, 0));
}

TEST_F(E57, DamagedIsRefusedInWords) {
  EXPECT_NE(error("ply").find("a.e57: not an E57 file"), std::string::npos);
  const std::string good = bytes();
  for (const std::size_t size : {std::size_t{8}, std::size_t{48}, good.size() - 1})
    EXPECT_NE(error(good.substr(0, size)).find("a.e57: the file is truncated"), std::string::npos) << size;
  for (const std::size_t size : {std::size_t{1024}, good.size() - 1024})
    EXPECT_NE(error(good.substr(0, size)).find("a.e57: the E57 file cannot be read"), std::string::npos) << size;
  std::string bad = good;
  bad[good.size() / 2] = static_cast<char>(bad[good.size() / 2] ^ 0x55);  // pages have check sums
  EXPECT_NE(error(bad).find("a.e57: the E57 file cannot be read"), std::string::npos);
}

#endif

}  // namespace
}  // namespace csrbf::e57_test
