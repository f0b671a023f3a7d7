#include "csrbf/io/gdal/gdal.hpp"

#include "csrbf/io/contour_lines.hpp"
#include "csrbf/io/samples.hpp"
#include "csrbf/io/volume.hpp"

#include "io/io_testing.hpp"

namespace csrbf::gdal_test {
namespace {

using testing::content;
using testing::io_error;
using testing::TemporaryFolder;

class Gdal : public ::testing::Test {
 protected:
  void SetUp() override {
    if (gdal_version().empty()) GTEST_SKIP() << "built without GDAL";
  }
  const TemporaryFolder folder_;
};

Volume<double> elevation() {
  Volume<double> dem;
  dem.grid.axes = 2;
  dem.grid.size = {4, 3, 1};
  dem.grid.spacing << 30, 30, 1;
  dem.grid.origin << 500015, 4650075, 0;
  dem.grid.direction(1, 1) = -1;
  dem.type = SampleType::float64;
  dem.crs = "EPSG:32633";
  dem.values = {1, 2, 3, 4, 5, std::numeric_limits<double>::quiet_NaN(), 7, 8, 9, 10, 11, 12.25};
  return dem;
}

TEST_F(Gdal, ImagesOnMapsComeBackTheSame) {
  for (const char* name : {"dem.asc", "dem.nc"}) {
    const Volume<double> dem = elevation();
    write_volume(folder_.file(name), dem);
    const auto back = read_volume<double>(folder_.file(name));
    EXPECT_EQ(back.grid.size, dem.grid.size) << name;
    EXPECT_LT((back.grid.origin - dem.grid.origin).norm(), 1e-6) << name;
    EXPECT_LT((back.grid.spacing - dem.grid.spacing).norm(), 1e-9) << name;
    EXPECT_EQ(back.crs, "EPSG:32633") << name;
    ASSERT_EQ(back.values.size(), dem.values.size());
    // Rows may be stored either way; the value at a place is the same.
    const bool turned = back.grid.direction(1, 1) > 0;
    for (Index y = 0; y < 3; ++y)
      for (Index x = 0; x < 4; ++x) {
        const double expected = dem.values[static_cast<std::size_t>(x + 4 * y)];
        const double found = back.values[static_cast<std::size_t>(x + 4 * (turned ? 2 - y : y))];
        EXPECT_TRUE(found == expected || (std::isnan(found) && std::isnan(expected))) << name << " " << x << " " << y;
      }
  }
  EXPECT_NE(content(folder_.file("dem.asc")).find("NODATA_value"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder_.file("dem.asc.writing")));
}

TEST_F(Gdal, ReferenceSystemsWithoutANumberGoThroughGdal) {
  Volume<double> dem = elevation();
  dem.crs = checked_crs("+proj=tmerc +lat_0=10 +lon_0=11 +k=0.5 +x_0=1 +y_0=2 +ellps=GRS80 +units=m");
  EXPECT_NE(dem.crs.find("PROJCS"), std::string::npos) << dem.crs;
  write_volume(folder_.file("dem.tif"), dem);
  EXPECT_EQ(read_volume<double>(folder_.file("dem.tif")).grid.origin, dem.grid.origin);
  EXPECT_EQ(checked_crs("epsg:32633"), "EPSG:32633");
  EXPECT_EQ(
      io_error([] { (void)checked_crs("EPSG:999999"); }).find("the reference system \"EPSG:999999\" is not known"), 0U);
  EXPECT_EQ(gdal_is_geographic("EPSG:7844"), true);
  EXPECT_EQ(gdal_is_geographic("EPSG:4647"), false);
}

TEST_F(Gdal, PointsOnMapsComeBackTheSame) {
  ResultTable table;
  table.coordinate_names = {"easting", "northing"};
  table.value_names = {"depth", "slope"};
  table.coordinates.resize(2, 3);
  table.coordinates << 500000.125, 500001, 500002, 4650000.5, 4650001, 4650002;
  table.values.resize(3, 2);
  table.values << 1.5, 0.25, 2.5, std::numeric_limits<double>::quiet_NaN(), 3.5, 0.75;
  table.crs = "EPSG:32633";
  for (const char* name : {"p.gpkg", "p.shp", "p.fgb"}) {
    write_table(folder_.file(name), table);
    const SampleTable back = read_samples(folder_.file(name), {.values = "depth"});
    EXPECT_EQ(back.coordinates, table.coordinates) << name;
    EXPECT_EQ(back.values.col(0), table.values.col(0)) << name;
    EXPECT_EQ(back.crs, "EPSG:32633") << name;
    EXPECT_EQ(read_samples(folder_.file(name)).value_names, std::vector<std::string>{"slope"}) << "the last field";
    EXPECT_EQ(read_samples(folder_.file(name)).dropped, 1) << name;
  }
}

TEST_F(Gdal, HeightsAreTheValueWhereThereIsNoField) {
  ResultTable table;
  table.coordinate_names = {"x", "y", "z"};
  table.coordinates.resize(3, 2);
  table.coordinates << 1, 2, 3, 4, 5, 6;
  table.values.resize(2, 0);
  write_table(folder_.file("p.gpkg"), table);
  const SampleTable back = read_samples(folder_.file("p.gpkg"));
  EXPECT_EQ(back.coordinate_names, (std::vector<std::string>{"x", "y"}));
  EXPECT_EQ(back.values.col(0), Eigen::Vector2d(5, 6));
}

TEST_F(Gdal, ContourLinesComeBackTheSame) {
  LevelLine open{-2.5, false, Points<2>(2, 3)}, closed{5, true, Points<2>(2, 3)};
  open.points << 500000.125, 500001, 500002, 4650000.5, 4650001, 4650003;
  closed.points << 500010, 500020, 500015, 4650000, 4650000, 4650010;
  for (const char* name : {"l.gpkg", "l.shp", "l.fgb"}) {
    write_level_lines(folder_.file(name), {open, closed}, {.value_name = "depth", .crs = "EPSG:32633"});
    const std::vector<Points<2>> lines = read_gdal_lines(folder_.file(name));
    ASSERT_EQ(lines.size(), 2U) << name;
    EXPECT_EQ(lines[0], open.points);
    ASSERT_EQ(lines[1].cols(), 4) << "closed lines end where they begin";
    EXPECT_EQ(lines[1].leftCols(3), closed.points);
    EXPECT_EQ(lines[1].col(3), closed.points.col(0));
    EXPECT_EQ(io_error([&] { (void)read_samples(folder_.file(name)); }),
              folder_.file(name) + ": the file holds lines or polygons but no points");
  }
  write_level_lines(folder_.file("l.geojson"), {open, closed}, {.value_name = "depth"});
  EXPECT_NE(content(folder_.file("l.geojson")).find("\"depth\": -2.5"), std::string::npos);
  write_level_lines(folder_.file("none.gpkg"), {});
  EXPECT_EQ(io_error([&] { (void)read_gdal_lines(folder_.file("none.gpkg")); }),
            folder_.file("none.gpkg") + ": the file holds no lines");
}

TEST_F(Gdal, FaultsAreTheLinesOfAMap) {
  const std::string path = folder_.with("faults.geojson",
                                        R"({"type":"FeatureCollection","features":[
{"type":"Feature","properties":{"name":"a"},"geometry":{"type":"MultiLineString","coordinates":[[[0,0],[1,1],[2,1]],[[5,5],[6,6]]]}},
{"type":"Feature","properties":{},"geometry":{"type":"Point","coordinates":[9,9]}},
{"type":"Feature","properties":{},"geometry":{"type":"Polygon","coordinates":[[[0,0],[1,0],[1,1],[0,0]]]}}]})");
  const std::vector<Eigen::Matrix2Xd> faults = read_faults(path);
  ASSERT_EQ(faults.size(), 3U);
  EXPECT_EQ(faults[0], (Eigen::Matrix2Xd(2, 3) << 0, 1, 2, 0, 1, 1).finished());
  EXPECT_EQ(faults[1], (Eigen::Matrix2Xd(2, 2) << 5, 6, 5, 6).finished());
  EXPECT_EQ(faults[2].cols(), 4);
}

TEST_F(Gdal, DamagedFilesAreRefusedInWords) {
  for (const char* name : {"a.asc", "a.nc", "a.gpkg", "a.shp", "a.geojson"}) {
    const std::string path = folder_.with(name, "this is no map");
    const bool is_image = is_volume_file(path);
    const std::string message = io_error([&] { is_image ? (void)read_volume<float>(path) : (void)read_samples(path); });
    EXPECT_EQ(message.find(path + ": "), 0U) << message;
    EXPECT_NE(message.find("GDAL"), std::string::npos) << message;
  }
  const std::string lines = folder_.with(
      "lines.geojson",
      R"({"type":"FeatureCollection","features":[{"type":"Feature","properties":{},"geometry":{"type":"LineString","coordinates":[[0,0],[1,1]]}}]})");
  EXPECT_EQ(io_error([&] { (void)read_samples(lines); }), lines + ": the file holds lines or polygons but no points");
  EXPECT_EQ(io_error([&] { write_volume("/nowhere/dem.asc", elevation()); }).find("/nowhere/dem.asc: "), 0U);
}

}  // namespace
}  // namespace csrbf::gdal_test
