#include "csrbf/io/points.hpp"

#include "io/io_testing.hpp"

namespace csrbf::ptx_test {
namespace {

using testing::io_error;
using testing::TemporaryFolder;

// A scan of 2 x 2 points turned by a quarter about z and moved to map coordinates, as scanners write it; the second
// point has no return.
const std::string turned =
    "2\n2\n500000.5 4650000.25 100\n0 1 0\n-1 0 0\n0 0 1\n"
    "0 1 0 0\n-1 0 0 0\n0 0 1 0\n500000.5 4650000.25 100 1\n"
    "1 2 3 0.25 255 0 10\n0 0 0 0.5 0 0 0\n-1 0 0.125 1 1 2 3\n0 0.001 0 0 9 9 9\n";
const std::string plain = "1\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n7 8 9 0.75\n";

PointCloud parse(const std::string& text) {
  return parse_points(".ptx", text, "a.ptx");
}

std::string failure(const std::string& text) {
  return io_error([&] { (void)parse(text); });
}

TEST(Ptx, ScansAreInTheirPlaceWithAllDigits) {
  const PointCloud cloud = parse(turned);
  ASSERT_EQ(cloud.size(), 3);
  EXPECT_EQ(cloud.points.col(0), Point<3>(500000.5 - 2, 4650000.25 + 1, 103));
  EXPECT_EQ(cloud.points.col(1), Point<3>(500000.5, 4650000.25 - 1, 100.125));
  EXPECT_EQ(cloud.points.col(2), Point<3>(500000.5 - 0.001, 4650000.25, 100));
  ASSERT_EQ(cloud.properties.size(), 4U);
  EXPECT_EQ(cloud.properties[0].name, "intensity");
  EXPECT_EQ(cloud.properties[0].values, Eigen::Vector3d(0.25, 1, 0));
  EXPECT_EQ(cloud.properties[3].name, "blue");
  EXPECT_EQ(cloud.properties[3].values, Eigen::Vector3d(10, 3, 9));
}

TEST(Ptx, SeveralScansFollowEachOther) {
  const PointCloud cloud = parse(turned + plain);
  ASSERT_EQ(cloud.size(), 4);
  EXPECT_EQ(cloud.points.col(3), Point<3>(7, 8, 9));
  EXPECT_EQ(cloud.properties.size(), 1U) << "not all points have colours";
}

TEST(Ptx, DamagedFilesAreRefusedWithTheLine) {
  EXPECT_EQ(failure(""), "a.ptx: the file is empty");
  EXPECT_EQ(failure("x\n"), "a.ptx:1: \"x\" is not a whole number from 0 to 2147483648");
  EXPECT_NE(failure(plain.substr(0, plain.find("7 8"))).find("the scan ends after 0 of 1 points"), std::string::npos);
  EXPECT_NE(failure("1\n" + turned).find("a.ptx:3: expected 3 numbers"), std::string::npos);
  EXPECT_NE(failure("2000000000\n2000000000\n" + plain.substr(4)).find("more than the file can hold"),
            std::string::npos);
  std::string perspective = plain;
  perspective.replace(perspective.find("1 0 0 0\n"), 8, "1 0 0 2\n");
  EXPECT_NE(failure(perspective).find("is not that of a motion"), std::string::npos);
  EXPECT_NE(failure(plain.substr(0, plain.size() - 6) + "\n").find("expected x y z intensity"), std::string::npos);
}

TEST(Ptx, OtherFormatsOfScannersNeedTheirLibraries) {
  const TemporaryFolder folder;
  std::string laz(375, '\0');
  laz.replace(0, 4, "LASF");
  laz[104] = static_cast<char>(0x83);
  const std::string compressed = io_error([&] { (void)read_points(folder.with("a.copc.laz", laz)); });
  EXPECT_EQ(compressed.find(folder.file("a.copc.laz") + ": "), 0U) << compressed;
  EXPECT_NE(compressed.find("compressed"), std::string::npos) << compressed;
  EXPECT_EQ(io_error([&] { (void)read_points(folder.with("b.laz", "LAS?")); }),
            folder.file("b.laz") + ": not a LAS or LAZ file: it does not begin with LASF");
  const std::string e57 = io_error([&] { (void)read_points(folder.with("a.e57", "ASTM-E57")); });
  EXPECT_EQ(e57.find(folder.file("a.e57") + ": "), 0U) << e57;
  EXPECT_NE(e57.find("E57"), std::string::npos) << e57;
}

}  // namespace
}  // namespace csrbf::ptx_test
