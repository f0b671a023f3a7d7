#include "csrbf/io/images/geotiff.hpp"

#include "csrbf/io/gdal/gdal.hpp"
#include "csrbf/io/volume.hpp"

#include "io/io_testing.hpp"

namespace csrbf::geotiff_test {
namespace {

using testing::content;
using testing::io_error;
using testing::TemporaryFolder;

// 4 x 3 cells of 30 m with the north on top, upper left corner at 500000, 4650090.
Volume<float> elevation() {
  Volume<float> dem;
  dem.grid.axes = 2;
  dem.grid.size = {4, 3, 1};
  dem.grid.spacing << 30, 30, 1;
  dem.grid.origin << 500015, 4650075, 0;
  dem.grid.direction(1, 1) = -1;
  dem.crs = "EPSG:32633";
  dem.values = {1, 2, 3, 4, 5, std::numeric_limits<float>::quiet_NaN(), 7, 8, 9, 10, 11, 12.25F};
  return dem;
}

// The numbers after a tag of a little-endian file with one page.
template <class T>
std::vector<T> tag_of(const std::string& bytes, std::uint16_t wanted) {
  const auto at = load_scalar<std::uint32_t>(&bytes[4]);
  const auto entries = load_scalar<std::uint16_t>(&bytes[at]);
  for (std::size_t i = 0; i < entries; ++i) {
    const char* entry = &bytes[at + 2 + 12 * i];
    if (load_scalar<std::uint16_t>(entry) != wanted) continue;
    const auto count = load_scalar<std::uint32_t>(entry + 4);
    const char* data = count * sizeof(T) <= 4 ? entry + 8 : &bytes[load_scalar<std::uint32_t>(entry + 8)];
    std::vector<T> numbers;
    for (std::size_t k = 0; k < count; ++k) numbers.push_back(load_scalar<T>(data + k * sizeof(T)));
    return numbers;
  }
  return {};
}

TEST(GeoTiff, TheTagsSayWhereTheImageIs) {
  const TemporaryFolder folder;
  write_volume(folder.file("dem.tif"), elevation());
  const std::string bytes = content(folder.file("dem.tif"));
  EXPECT_EQ(tag_of<double>(bytes, 33550), (std::vector<double>{30, 30, 0}));
  EXPECT_EQ(tag_of<double>(bytes, 33922), (std::vector<double>{0, 0, 0, 500000, 4650090, 0}));
  EXPECT_EQ(tag_of<std::uint16_t>(bytes, 34735),
            (std::vector<std::uint16_t>{1, 1, 0, 3, 1024, 0, 1, 1, 1025, 0, 1, 1, 3072, 0, 1, 32633}));
  EXPECT_EQ(tag_of<char>(bytes, 42113), (std::vector<char>{'n', 'a', 'n', '\0'}));
  EXPECT_EQ(content(folder.file("dem.tfw")), "30\n0\n0\n-30\n500015\n4650075\n");
}

TEST(GeoTiff, WhatIsWrittenIsReadBackTheSame) {
  const TemporaryFolder folder;
  const Volume<float> dem = elevation();
  write_volume(folder.file("dem.tif"), dem);
  std::filesystem::remove(folder.file("dem.tfw"));
  const auto back = read_volume<float>(folder.file("dem.tif"));
  EXPECT_EQ(back.grid.origin, dem.grid.origin);
  EXPECT_EQ(back.grid.spacing, dem.grid.spacing);
  EXPECT_EQ(back.grid.direction, dem.grid.direction);
  EXPECT_EQ(back.crs, dem.crs);
  EXPECT_EQ(back.type, SampleType::float32);
  ASSERT_EQ(back.values.size(), dem.values.size());
  for (std::size_t i = 0; i < back.values.size(); ++i)
    EXPECT_TRUE(back.values[i] == dem.values[i] || (std::isnan(back.values[i]) && i == 5)) << i;
}

TEST(GeoTiff, AnyPlaceInSpaceIsReadBackToRounding) {
  const TemporaryFolder folder;
  Volume<float> stack = elevation();
  stack.grid.axes = 3;
  stack.grid.size = {2, 3, 2};
  stack.grid.spacing << 0.5, 0.25, 2;
  const double angle = 0.3;
  stack.grid.direction << std::cos(angle), -std::sin(angle), 0, std::sin(angle), std::cos(angle), 0, 0, 0, 1;
  stack.crs.clear();
  write_volume(folder.file("stack.tif"), stack);
  EXPECT_FALSE(std::filesystem::exists(folder.file("stack.tfw"))) << "world files are for images in the plane";
  const Grid back = read_volume<float>(folder.file("stack.tif")).grid;
  constexpr double rounding = 1e-9;  // of coordinates of some 1e6
  EXPECT_LT((back.origin - stack.grid.origin).norm(), rounding);
  EXPECT_LT((back.spacing - stack.grid.spacing).norm(), rounding);
  EXPECT_LT((back.direction - stack.grid.direction).norm(), rounding);
}

TEST(GeoTiff, ImagesWithoutAPlaceGetNone) {
  const TemporaryFolder folder;
  Volume<float> plain;
  plain.grid.axes = 2;
  plain.grid.size = {2, 2, 1};
  plain.values = {1, 2, 3, 4};
  write_volume(folder.file("plain.tif"), plain);
  EXPECT_TRUE(tag_of<double>(content(folder.file("plain.tif")), 33550).empty());
  EXPECT_TRUE(tag_of<std::uint16_t>(content(folder.file("plain.tif")), 34735).empty());
  EXPECT_FALSE(std::filesystem::exists(folder.file("plain.tfw")));
  EXPECT_FALSE(is_placed(read_volume<float>(folder.file("plain.tif"))));
}

TEST(GeoTiff, AWorldFileBesideAPlainImagePlacesIt) {
  const TemporaryFolder folder;
  Volume<float> plain;
  plain.grid.axes = 2;
  plain.grid.size = {2, 2, 1};
  plain.type = SampleType::uint8;
  plain.values = {1, 2, 3, 4};
  write_volume(folder.file("a.png"), plain);
  (void)folder.with("a.pgw", "10\n0\n0\n-20\n1000.5\n2000.25\n");
  const Grid grid = read_volume<float>(folder.file("a.png")).grid;
  EXPECT_EQ(grid.origin, Point<3>(1000.5, 2000.25, 0));
  EXPECT_EQ(grid.spacing, Point<3>(10, 20, 1));
  EXPECT_EQ(grid.direction(1, 1), -1);
  (void)folder.with("a.pgw", "10\n0\n0\n");
  EXPECT_EQ(io_error([&] { (void)read_volume<float>(folder.file("a.png")); }),
            folder.file("a.pgw") + ": a world file has six lines with a number each");
  (void)folder.with("a.pgw", "0\n0\n0\n0\n0\n0\n");
  EXPECT_NE(io_error([&] { (void)read_volume<float>(folder.file("a.png")); }).find("singular"), std::string::npos);
}

TEST(GeoTiff, ReferenceSystemsAreEpsgCodes) {
  EXPECT_EQ(epsg_code("EPSG:32633"), 32633);
  EXPECT_EQ(epsg_code("epsg:4326"), 4326);
  EXPECT_EQ(epsg_code("EPSG:x"), std::nullopt);
  EXPECT_EQ(epsg_code("UTM33"), std::nullopt);
  EXPECT_EQ(is_geographic("EPSG:4326"), true);
  EXPECT_EQ(is_geographic("EPSG:4258"), true);
  EXPECT_EQ(is_geographic("EPSG:32633"), false);
  EXPECT_EQ(is_geographic("EPSG:3857"), false);
  EXPECT_EQ(is_geographic(""), std::nullopt);
  const TemporaryFolder folder;
  Volume<float> dem = elevation();
  dem.crs = "EPSG:4326";
  write_volume(folder.file("a.tif"), dem);
  const auto keys = tag_of<std::uint16_t>(content(folder.file("a.tif")), 34735);
  EXPECT_EQ(std::vector<std::uint16_t>(keys.begin() + 4, keys.end()),
            (std::vector<std::uint16_t>{1024, 0, 1, 2, 1025, 0, 1, 1, 2048, 0, 1, 4326}));
  EXPECT_EQ(read_volume<float>(folder.file("a.tif")).crs, "EPSG:4326");
}

TEST(GeoTiff, PointsAtTheCentresOfPixelsAreUnderstood) {
  const TemporaryFolder folder;
  write_volume(folder.file("a.tif"), elevation());
  std::string bytes = content(folder.file("a.tif"));
  // RasterPixelIsPoint instead of RasterPixelIsArea.
  const std::string area("\x01\x04\0\0\x01\0\x01\0", 8), point("\x01\x04\0\0\x01\0\x02\0", 8);
  ASSERT_NE(bytes.find(area), std::string::npos);
  bytes.replace(bytes.find(area), area.size(), point);
  const Grid grid = read_volume<float>(folder.with("point.tif", bytes)).grid;
  EXPECT_EQ(grid.origin, Point<3>(500000, 4650090, 0)) << "the tie point is the centre of the first pixel";
}

TEST(GeoTiff, AValueThatMeansNoDataBecomesNan) {
  RawVolume raw;
  raw.layout.grid.size = {3, 1, 1};
  raw.layout.type = SampleType::int16;
  raw.bytes.resize(6);
  raw.order = std::endian::little;
  for (const int i : {0, 1, 2})
    store_scalar(&raw.bytes[static_cast<std::size_t>(2 * i)], std::int16_t(i == 1 ? -9999 : 5 + i));
  raw.no_data = -9999;
  const Volume<float> image = decode_samples<float>(raw);
  EXPECT_EQ(image.values[0], 5);
  EXPECT_TRUE(std::isnan(image.values[1]));
  EXPECT_EQ(image.values[2], 7);
  EXPECT_EQ(image.type, SampleType::float32);
  raw.layout.type = SampleType::uint16;
  raw.no_data = 5;
  EXPECT_EQ(decode_samples<float>(raw).values[0], 5) << "labels are unsigned, and keep their 0";
}

TEST(GeoTiff, DamagedPlacesAreRefused) {
  const TemporaryFolder folder;
  write_volume(folder.file("a.tif"), elevation());
  std::string bytes = content(folder.file("a.tif"));
  std::string thirty(8, '\0');
  store_scalar(thirty.data(), 30.0);
  std::string nothing(8, '\0');
  for (std::size_t at = bytes.find(thirty); at != std::string::npos; at = bytes.find(thirty))
    bytes.replace(at, 8, nothing);
  const std::string message = io_error([&] { (void)read_volume<float>(folder.with("b.tif", bytes)); });
  EXPECT_NE(message.find("b.tif: the place on the map: "), std::string::npos) << message;
}

}  // namespace
}  // namespace csrbf::geotiff_test
