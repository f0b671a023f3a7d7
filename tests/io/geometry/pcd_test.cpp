#include "csrbf/io/files/bytes.hpp"
#include "csrbf/io/geometry/formats.hpp"

#include "io/io_testing.hpp"

namespace csrbf::pcd_test {
namespace {

using testing::io_error;

std::string head(const std::string& data) {
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z rgb normal_x normal_y normal_z skip "
         "ring\nSIZE 4 4 4 4 4 4 4 1 2\nTYPE F F F F F F F U U\nCOUNT 1 1 1 1 1 1 1 3 1\nWIDTH 2\nHEIGHT 1\n"
         "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA " +
         data + "\n";
}

// One row of 33 bytes; the packed colour is a NaN as a float.
std::string row(float first) {
  std::string bytes;
  for (const float x : {first, first + 1, first + 2}) append_scalar(bytes, x);
  append_scalar(bytes, std::uint32_t{0xFF8040C0});
  for (const float n : {0.F, 0.F, 1.F}) append_scalar(bytes, n);
  bytes += "abc";
  append_scalar(bytes, std::uint16_t{17});
  return bytes;
}

void expect_two_points(const PointCloud& cloud, bool colored = true) {
  ASSERT_EQ(cloud.size(), 2);
  EXPECT_EQ(cloud.points.col(1), Point<3>(5, 6, 7));
  EXPECT_EQ(cloud.normals.col(1), Point<3>(0, 0, 1));
  ASSERT_EQ(cloud.properties.size(), 4U);
  EXPECT_EQ(cloud.properties[3].name, "ring");
  EXPECT_EQ(cloud.properties[3].type, "ushort");
  EXPECT_EQ(cloud.properties[3].values[1], 17);
  for (Index c = 0; c < 3 && colored; ++c)
    EXPECT_EQ(cloud.properties[static_cast<std::size_t>(c)].values[0], Point<3>(128, 64, 192)[c]);
}

TEST(Pcd, IsReadAsTextAndBinary) {
  const std::string text = head("ascii") + "1 2 3 4.2108e+06 0 0 1 9 9 9 17\n5 6 7 0 0 0 1 9 9 9 17\n";
  expect_two_points(parse_pcd(text, "a.pcd"), false);
  expect_two_points(parse_pcd(head("binary") + row(1) + row(5), "a.pcd"));
}

// The values field by field, as runs of literals and, for the equal colours, normals and rings, copies.
TEST(Pcd, IsReadCompressed) {
  std::string full;
  const std::string rows[] = {row(1), row(5)};
  for (const auto& [begin, size] :
       {std::pair{0, 4}, {4, 4}, {8, 4}, {12, 4}, {16, 4}, {20, 4}, {24, 4}, {28, 3}, {31, 2}})
    for (const std::string& one : rows)
      full += one.substr(static_cast<std::size_t>(begin), static_cast<std::size_t>(size));
  std::string packed;
  for (std::size_t i = 0; i < full.size();) {
    if (i == 28 || i == 44) {  // four bytes again: the second colour, and the zeros of a normal
      packed += std::string{static_cast<char>(2 << 5), 3};
      i += 4;
    } else {
      packed += '\0';
      packed += full[i++];
    }
  }
  const auto file = [&](std::size_t size) {
    std::string bytes = head("binary_compressed");
    append_scalar(bytes, static_cast<std::uint32_t>(packed.size()));
    append_scalar(bytes, static_cast<std::uint32_t>(size));
    return bytes + packed;
  };
  expect_two_points(parse_pcd(file(full.size()), "a.pcd"));
  for (const std::size_t size : {full.size() - 1, full.size() + 1})
    EXPECT_NE(io_error([&] { parse_pcd(file(size), "a.pcd"); }).find("damaged"), std::string::npos);
}

TEST(Pcd, ThatIsDamagedIsRefused) {
  const auto error = [](const std::string& bytes) { return io_error([&] { parse_pcd(bytes, "a.pcd"); }); };
  const std::string good = head("binary") + row(1) + row(5);
  EXPECT_NE(error(good.substr(0, good.size() - 1)).find("room for 1 of its 2 points"), std::string::npos);
  EXPECT_NE(error(head("ascii") + "1 2 3\n").find("a.pcd:"), std::string::npos);
  EXPECT_NE(error("hello").find("does not belong"), std::string::npos);
  EXPECT_NE(error("FIELDS x y\nSIZE 4 4\nTYPE F F\nPOINTS 0\nDATA ascii\n").find("x, y and z"), std::string::npos);
  EXPECT_NE(error("FIELDS x y z\nSIZE 4 4\n").find("one entry for each"), std::string::npos);
  EXPECT_NE(error("FIELDS x\nSIZE 3\nTYPE F\nDATA ascii\n").find("not known"), std::string::npos);
  EXPECT_NE(error("FIELDS x\nDATA ascii\n").find("TYPE"), std::string::npos);
  EXPECT_NE(error("FIELDS x\n").find("DATA"), std::string::npos);
  EXPECT_NE(error("POINTS 2\nDATA ascii\n1\n2\n").find("FIELDS"), std::string::npos);
}

}  // namespace
}  // namespace csrbf::pcd_test
