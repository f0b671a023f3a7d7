#include "csrbf/io/geometry/formats.hpp"

#include "io/io_testing.hpp"

namespace csrbf::laz_test {
namespace {

using testing::io_error;

// Five points of format 3, in chunks of three, as laz-perf 1.5 wrote them: the i-th is at
// (500000 + .01 (1 + 7 i), 4650000 + .01 (i^2 - 1), 100 + .25 i).
constexpr std::string_view written_by_laz_perf =
    "4c4153460000000000000000000000000000000000000000010200000000000000000000000000000000000000000000000000000000"
    "00000000000000000000000000000000000000000000000000000000000000000000000000000000e3004d0100000100000083220005"
    "00000000000000000000000000000000000000000000007b14ae47e17a843f7b14ae47e17a843f000000000000d03f0000000080841e"
    "410000000004bd514100000000000059408fc2f52881841e41a4703d0a80841e419a99990904bd5141f6285cff03bd51410000000000"
    "405940000000000000594000006c61737a697020656e636f6465640000bc5634006c617a2d706572662076617269616e740000e9b61b"
    "c91c560000f8cefe39fd7f02000000020200000000000003000000ffffffffffffffffffffffffffffffff0300060014000200070008"
    "000200080006000200d50100000000000001000000ffffffff00000000e8031a02000007000000004087d632410a0a0b0b0c0c6294a3"
    "f0fdd91dc376b1624c6d0e1b0000006a418f4b4d3e7a3ceb271b620639000000800000160000000800000003000000eb031a06000007"
    "00000000408ad632410d0d0e0e0f0f6294d0d8cf48fb4353746dd193b5916e00000100000000000000020000003a9bcc000000";

std::string laz_file() {
  std::string bytes;
  const auto digit = [](char c) { return c <= '9' ? c - '0' : c - 'a' + 10; };
  for (std::size_t i = 0; i < written_by_laz_perf.size(); i += 2)
    bytes += static_cast<char>(16 * digit(written_by_laz_perf[i]) + digit(written_by_laz_perf[i + 1]));
  return bytes;
}

std::string error(const std::string& bytes) {
  return io_error([&] { parse_laz(bytes, "a.laz"); });
}

TEST(Laz, HasThePointsThatWereCompressed) {
  if (!reads_laz()) {
    EXPECT_NE(
        error(laz_file()).find("a.laz: its points are compressed (LAZ), which this build cannot read; convert it"),
        std::string::npos);
    GTEST_SKIP() << "neither laz-perf nor LASzip was found";
  }
  const PointCloud cloud = parse_laz(laz_file(), "a.laz");
  ASSERT_EQ(cloud.size(), 5);
  const auto values = [&](const std::string& name) {
    for (const Property& p : cloud.properties)
      if (p.name == name) return p.values;
    return Eigen::VectorXd();
  };
  for (Index i = 0; i < 5; ++i) {
    const Point<3> steps(1. + 7. * static_cast<double>(i), static_cast<double>(i * i - 1), static_cast<double>(i));
    const Point<3> p = Point<3>(500000, 4650000, 100) + steps.cwiseProduct(Point<3>(.01, .01, .25));
    EXPECT_TRUE(cloud.points.col(i).isApprox(p, 1e-15)) << i;
    EXPECT_EQ(values("intensity")[i], 1000 + static_cast<double>(i));
    EXPECT_EQ(values("classification")[i], i % 2 == 0 ? 2 : 6);
    EXPECT_EQ(values("gps_time")[i], 1234567.25 + static_cast<double>(i));
    EXPECT_EQ(values("blue")[i], 12 + static_cast<double>(i));
  }
}

TEST(Laz, ThatIsDamagedIsRefusedInWords) {
  EXPECT_NE(error("ply").find("a.laz: not a LAS or LAZ file"), std::string::npos);
  EXPECT_NE(error("LASF").find("a.laz: the file is truncated"), std::string::npos);
  for (const std::size_t size : {std::size_t{230}, std::size_t{300}})
    EXPECT_NE(error(laz_file().substr(0, size)).find("a.laz: "), std::string::npos) << size;
}

}  // namespace
}  // namespace csrbf::laz_test
