#include "csrbf/io/files/bytes.hpp"
#include "csrbf/io/geometry/formats.hpp"

#include "io/io_testing.hpp"

namespace csrbf::las_test {
namespace {

using testing::io_error;

constexpr std::size_t sizes[] = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};

// Two points of a format, at (500000.01, 4649999.99, 100.25) and one step further on every axis, as version 1.minor.
std::string las_file(unsigned format, unsigned minor, unsigned flags_of_second = 0) {
  const std::size_t head = minor == 4 ? 375 : 227, size = sizes[format] + 3;  // with bytes of a user
  std::string bytes(head + 2 * size, '\0');
  const auto put = [&](std::size_t at, auto value) { store_scalar(bytes.data() + at, value); };
  bytes.replace(0, 4, "LASF");
  put(24, std::uint8_t{1});
  put(25, static_cast<std::uint8_t>(minor));
  put(96, static_cast<std::uint32_t>(head));
  put(104, static_cast<std::uint8_t>(format));
  put(105, static_cast<std::uint16_t>(size));
  put(minor == 4 ? 247 : 107, std::uint32_t{2});
  const double scale[] = {.01, .01, .25}, offset[] = {500000, 4650000, 100};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    put(131 + 8 * axis, scale[axis]);
    put(155 + 8 * axis, offset[axis]);
  }
  for (std::size_t i = 0; i < 2; ++i) {
    const std::size_t p = head + i * size;
    const bool is_long = format >= 6;
    const std::int32_t steps[] = {1, -1, 1};
    for (std::size_t axis = 0; axis < 3; ++axis) put(p + 4 * axis, static_cast<std::int32_t>(steps[axis] + i));
    put(p + 12, static_cast<std::uint16_t>(1000 + i));
    put(p + 14, static_cast<std::uint8_t>(is_long ? 2 | 3 << 4 : 2 | 3 << 3));
    put(p + 15, static_cast<std::uint8_t>(is_long ? flags_of_second * i : (2 + 4 * i) | (flags_of_second * i)));
    if (is_long) put(p + 16, static_cast<std::uint8_t>(2 + 4 * i));
    put(p + (is_long ? 20 : 18), std::uint16_t{7});
    const bool has_time = is_long || format == 1 || format >= 3;
    if (has_time) put(p + (is_long ? 22 : 20), 1234567.25 + static_cast<double>(i));
    const bool has_color = format == 2 || format == 3 || format == 5 || format == 7 || format == 8 || format == 10;
    if (has_color)
      for (std::size_t c = 0; c < 3; ++c)
        put(p + (is_long ? 30 : format == 2 ? 20 : 28) + 2 * c, static_cast<std::uint16_t>(257 * (10 + c + i)));
  }
  return bytes;
}

double value(const PointCloud& cloud, const std::string& name, Index i) {
  for (const Property& p : cloud.properties)
    if (p.name == name) return p.values[i];
  return std::numeric_limits<double>::quiet_NaN();
}

TEST(Las, HasCoordinatesWithAllDigitsAndPropertiesInEveryPointFormat) {
  for (unsigned format = 0; format <= 10; ++format) {
    SCOPED_TRACE(format);
    const PointCloud cloud = parse_las(las_file(format, format >= 6 ? 4 : format >= 4 ? 3 : 2), "a.las");
    ASSERT_EQ(cloud.size(), 2);
    EXPECT_EQ(cloud.points.col(0), Point<3>(500000 + .01, 4650000 - .01, 100.25));
    EXPECT_EQ(cloud.points.col(1), Point<3>(500000 + .02, 4650000, 100.5));
    EXPECT_EQ(value(cloud, "intensity", 1), 1001);
    EXPECT_EQ(value(cloud, "return_number", 0), 2);
    EXPECT_EQ(value(cloud, "number_of_returns", 0), 3);
    EXPECT_EQ(value(cloud, "classification", 0), 2);
    EXPECT_EQ(value(cloud, "classification", 1), 6);
    EXPECT_EQ(value(cloud, "point_source_id", 0), 7);
    const bool has_time = format == 1 || format >= 3;
    EXPECT_EQ(std::isfinite(value(cloud, "gps_time", 1)), has_time);
    if (has_time) {
      EXPECT_EQ(value(cloud, "gps_time", 1), 1234568.25);
    }
    const bool has_color = format == 2 || format == 3 || format == 5 || format == 7 || format == 8 || format == 10;
    EXPECT_EQ(value(cloud, "blue", 1) == 13, has_color);
  }
}

TEST(Las, LeavesOutWithheldPoints) {
  EXPECT_EQ(parse_las(las_file(1, 2, 0x80), "a.las").size(), 1);
  EXPECT_EQ(parse_las(las_file(6, 4, 4), "a.las").size(), 1);
}

TEST(Las, OfOtherKindsAndDamagedOnesAreRefused) {
  const auto error = [](const std::string& bytes) { return io_error([&] { parse_las(bytes, "a.las"); }); };
  const std::string good = las_file(3, 2);
  EXPECT_NE(error("PLY").find("a.las: not a LAS file"), std::string::npos);
  for (const std::size_t size : {50, 226, 227, 300})
    EXPECT_NE(error(good.substr(0, size)).find("truncated"), std::string::npos) << size;
  std::string other = good;
  other[104] = static_cast<char>(0x83);
  EXPECT_NE(error(other).find("LAZ"), std::string::npos);
  other[104] = 11;
  EXPECT_NE(error(other).find("point format 11"), std::string::npos);
  other = good;
  other[25] = 5;
  EXPECT_NE(error(other).find("version 1.5"), std::string::npos);
  other = good;
  store_scalar(other.data() + 131, 0.0);
  EXPECT_NE(error(other).find("scale"), std::string::npos);
  other = good;
  store_scalar(other.data() + 107, std::uint32_t{0xFFFFFFFF});
  EXPECT_NE(error(other).find("truncated"), std::string::npos);
}

}  // namespace
}  // namespace csrbf::las_test
