#include "csrbf/io/samples.hpp"

#include "csrbf/io/files/npy.hpp"
#include "csrbf/io/volume.hpp"

#include "io/io_testing.hpp"

namespace csrbf::samples_test {
namespace {

using testing::content;
using testing::io_error;
using testing::TemporaryFolder;
using Names = std::vector<std::string>;

Eigen::MatrixXd two_points() {
  Eigen::MatrixXd p(2, 2);
  p << 1, 4, 2, 5;
  return p;
}

TEST(ReadSamples, TakesTheValueFromTheLastColumn) {
  const TemporaryFolder folder;
  const std::vector<std::pair<std::string, std::string>> files{{"a.csv", "1,2,3\n4,5,6\n"},
                                                               {"b.csv", "x,y,value\n1,2,3\n4,5,6"},
                                                               {"c.txt", "# x y value\n1 2 3\n4 5 6\n"},
                                                               {"d.tsv", "x\ty\tvalue\n1\t2\t3\n4\t5\t6\n"},
                                                               {"e.dat", "1;2;3\r\n4;5;6\r\n"},
                                                               {"f.npy", format_npy({{2, 3}, {1, 2, 3, 4, 5, 6}})}};
  for (const auto& [name, text] : files) {
    const SampleTable samples = read_samples(folder.with(name, text));
    EXPECT_EQ(samples.coordinates, two_points()) << name;
    EXPECT_EQ(samples.values, Eigen::Vector2d(3, 6)) << name;
    EXPECT_EQ(samples.weights.size(), 0) << name;
    EXPECT_EQ(samples.coordinate_names, (Names{"x", "y"})) << name;
    EXPECT_EQ(samples.value_names, Names{"value"}) << name;
    EXPECT_EQ(samples.dropped, 0) << name;
  }
}

TEST(ReadSamples, CellsBetweenTabsMayHoldBlanksOrNothing) {
  const TemporaryFolder folder;
  const auto read = [&](const std::string& text) { return read_samples(folder.with("a.tsv", text), {.values = "3"}); };
  const SampleTable named = read("Lon [deg]\tLat [deg]\tHead (m)\n1\t2\t3\n4\t5\t6\n");
  EXPECT_EQ(named.coordinates, two_points());
  EXPECT_EQ(named.coordinate_names, (Names{"Lon [deg]", "Lat [deg]"}));
  EXPECT_EQ(read("x\ty\tv\tw\n1\t2\t3\t1\n7\t\t9\t1\n4\t5\t6\t1\n").dropped, 1);
  EXPECT_EQ(read("x\ty\tv\tw\n1\t2\t3\t1\n\t8\t9\t1\r\n4\t5\t6\t1\n\t\t\t\n").dropped, 1);
  EXPECT_EQ(read("x\ty\tv\tw\n1\t2\t3\t\n4\t5\t6\t1\n").dropped, 1);
  EXPECT_EQ(read("x\ty\tv\tw\n1\t2\t3\t1\t\n4\t5\t6\t # no w\n").dropped, 1);
  // Blanks and tabs in any mixture, as before.
  EXPECT_EQ(read("x y\tv\n1 2\t3\n4\t5 6\n").coordinates, two_points());
  EXPECT_EQ(read("x\ty\tv\n1 2 3\n4 5 6\n").coordinates, two_points());
}

TEST(ReadSamples, AColumnThatNumbersTheRowsIsSuspected) {
  const TemporaryFolder folder;
  const auto suspicion = [&](const std::string& head, const std::string& row, const SampleColumns& columns = {}) {
    std::string text = head;
    for (const char* i : {"1", "2", "3", "4", "5", "6"}) {
      std::string line = row;
      line.replace(line.find('#'), 1, i);
      text += line + "\n";
    }
    return read_samples(folder.with("a.csv", text), columns).suspicion;
  };
  EXPECT_EQ(suspicion("ID,x,y,v\n", "#7,.5,.25,1"), "ID") << "by its name";
  EXPECT_EQ(suspicion("n,x,y,v\n", "#,.5,.25,1"), "n") << "by its numbers";
  EXPECT_EQ(suspicion("", "#,.5,.25,1"), "number 1");
  EXPECT_EQ(suspicion("x,y,v,fid\n", ".5,.25,1,#"), "fid") << "as a value";
  EXPECT_EQ(suspicion("t,v\n", "#,1"), "") << "the only coordinate may count";
  EXPECT_EQ(suspicion("x,y,v\n", "#.5,.25,1"), "");
  EXPECT_EQ(suspicion("id,x,y,v\n", "#,.5,.25,1", {.coordinates = "x,y"}), "");
  EXPECT_EQ(suspicion("id,x,y,v\n", "#,.5,.25,1", {.coordinates = "id,x,y"}), "") << "who names it means it";
}

TEST(ReadSamples, AColumnOfDeviationsIsSuspected) {
  const TemporaryFolder folder;
  const auto deviation = [&](const std::string& head, const std::string& row, const SampleColumns& columns = {}) {
    return read_samples(folder.with("a.csv", head + "\n" + row + "\n"), columns).deviation;
  };
  EXPECT_EQ(deviation("x,y,v,sigma", "1,2,3,.1"), "sigma") << "as the value";
  EXPECT_EQ(deviation("x,y,StdDev,v", "1,2,.1,3"), "StdDev") << "as a coordinate";
  EXPECT_EQ(deviation("x,y,v,weight", "1,2,3,1"), "weight");
  EXPECT_EQ(deviation("x,y,v,weight", "1,2,3,1", {.weights = "weight"}), "");
  EXPECT_EQ(deviation("x,y,v,sigma", "1,2,3,.1", {.coordinates = "x,y", .values = "v"}), "");
  EXPECT_EQ(deviation("x,y,v,sigma", "1,2,3,.1", {.values = "sigma"}), "") << "who names it means it";
  EXPECT_EQ(deviation("depth,sigma", "1,2", {}), "") << "there is no other value";
  EXPECT_EQ(deviation("x,y,v", "1,2,3"), "");
  EXPECT_EQ(deviation("sigma_x,weighting,v", "1,2,3"), "");
}

TEST(ReadSamples, PointCloudsAreHeightsOverThePlane) {
  const TemporaryFolder folder;
  PointCloud cloud;
  cloud.points.resize(3, 3);
  cloud.points << 1, 2, 3, 4, 5, 6, 7, 8, 9;
  cloud.properties = {{"classification", "uchar", Eigen::Vector3d(2, 5, 2)},
                      {"return_number", "uchar", Eigen::Vector3d(1, 1, 2)},
                      {"number_of_returns", "uchar", Eigen::Vector3d(1, 2, 2)}};
  write_points(folder.file("a.ply"), cloud);
  const SampleTable all = read_samples(folder.file("a.ply"));
  EXPECT_EQ(all.coordinate_names, (Names{"x", "y"}));
  EXPECT_EQ(all.value_names, Names{"z"});
  EXPECT_EQ(all.values, Eigen::Vector3d(7, 8, 9));
  EXPECT_EQ(read_samples(folder.file("a.ply"), {.points = {.classes = {2}}}).values, Eigen::Vector2d(7, 9));
  EXPECT_EQ(read_samples(folder.file("a.ply"), {.points = {.classes = {2}, .returns = "first"}}).values(0), 7);
  EXPECT_EQ(read_samples(folder.file("a.ply"), {.points = {.returns = "last"}}).values, Eigen::Vector2d(7, 9));
  EXPECT_EQ(read_samples(folder.file("a.ply"), {.points = {.returns = "only"}}).values.size(), 1);
  EXPECT_EQ(read_samples(folder.file("a.ply"), {.values = "classification"}).values, Eigen::Vector3d(2, 5, 2));
  EXPECT_THROW((void)read_samples(folder.file("a.ply"), {.points = {.classes = {6}}}), InvalidInput);
  write_points(folder.file("a.csv"), cloud);
  const SampleTable of_text = read_samples(folder.file("a.csv"), {.points = {.classes = {2}}});
  EXPECT_EQ(of_text.values, Eigen::Vector2d(7, 9));
  EXPECT_EQ(of_text.coordinate_names, (Names{"x", "y"}));
  const std::string bare = format_npy({{2, 3}, {1, 2, 3, 4, 5, 6}});
  EXPECT_THROW((void)read_samples(folder.with("a.npy", bare), {.points = {.classes = {2}}}), InvalidInput);
  EXPECT_THROW((void)read_samples(folder.with("b.csv", "1,2,3\n"), {.points = {.classes = {2}}}), InvalidInput);
}

TEST(ReadSamples, PixelsOnAMapAreSamplesAtTheirCentres) {
  const TemporaryFolder folder;
  Volume<float> dem;
  dem.grid.axes = 2;
  dem.grid.size = {2, 2, 1};
  dem.grid.spacing << 10, 20, 1;
  dem.grid.origin << 105, 190, 0;
  dem.grid.direction(1, 1) = -1;
  dem.crs = "EPSG:32633";
  dem.values = {1, 2, std::numeric_limits<float>::quiet_NaN(), 4};
  write_volume(folder.file("dem.tif"), dem);
  const SampleTable samples = read_samples(folder.file("dem.tif"));
  Eigen::MatrixXd expected(2, 3);
  expected << 105, 115, 115, 190, 190, 170;
  EXPECT_EQ(samples.coordinates, expected);
  EXPECT_EQ(samples.values, Eigen::Vector3d(1, 2, 4));
  EXPECT_EQ(samples.dropped, 1);
  EXPECT_EQ(samples.crs, "EPSG:32633");
  EXPECT_NE(io_error([&] {
              (void)read_samples(folder.file("dem.tif"), {.points = {.classes = {2}}});
            }).find("only points of a scanner have classes"),
            std::string::npos);
}

TEST(ReadSamples, PicksColumnsByNameAndNumber) {
  const TemporaryFolder folder;
  const std::string path = folder.with("a.csv", "station,v,x,sigma,y,u\nOslo,3,1,0.5,2,7\n\"Rio\",6,4,0.25,5,8\n");
  const SampleTable named = read_samples(path, {.coordinates = "x,y", .values = "v, u", .weights = "sigma"});
  EXPECT_EQ(named.coordinates, two_points());
  Eigen::Matrix2d values;
  values << 3, 7, 6, 8;
  EXPECT_EQ(named.values, values);
  EXPECT_EQ(named.weights, Eigen::Vector2d(0.5, 0.25));
  EXPECT_EQ(named.coordinate_names, (Names{"x", "y"}));
  EXPECT_EQ(named.value_names, (Names{"v", "u"}));
  const SampleTable numbered = read_samples(path, {.coordinates = "3,5", .values = "2"});
  EXPECT_EQ(numbered.coordinates, two_points());
  EXPECT_EQ(numbered.values, Eigen::Vector2d(3, 6));
  EXPECT_EQ(read_samples(path, {.coordinates = "x"}).value_names, Names{"u"});
}

TEST(ReadSamples, TakesAllOtherColumnsAsCoordinates) {
  const TemporaryFolder folder;
  const std::string path = folder.with("a.csv", "3,1,9,2\n6,4,9,5\n");
  const SampleTable samples = read_samples(path, {.values = "1", .weights = "3"});
  EXPECT_EQ(samples.coordinates, two_points());
  EXPECT_EQ(samples.weights, Eigen::Vector2d(9, 9));
  EXPECT_EQ(read_samples(folder.with("b.txt", "1 2 3 4 5\n")).coordinate_names, (Names{"x1", "x2", "x3", "x4"}));
  EXPECT_EQ(read_samples(path, {.coordinates = "1", .values = "2,3"}).value_names, (Names{"value1", "value2"}));
}

TEST(ReadSamples, FindsCommentsOutsideOfQuotes) {
  const TemporaryFolder folder;
  const std::string text =
      "id,x,depth\n\"hole #1\",1,5 # first\n\"see http://a.org\",2,6\n\"say \"\"#\"\", then\",3,7 // last\n3\" "
      "pipe,4,8# old\n";
  const SampleTable samples = read_samples(folder.with("s.csv", text), {.coordinates = "x", .values = "depth"});
  EXPECT_EQ(samples.coordinates, Eigen::RowVector4d(1, 2, 3, 4));
  EXPECT_EQ(samples.values, Eigen::Vector4d(5, 6, 7, 8));
}

TEST(ReadSamples, DropsRowsWhoseNumbersAreMissing) {
  const TemporaryFolder folder;
  const std::string path =
      folder.with("a.csv", "x,y,v,w\n1,2,3,\n1,,3,1\n0,0,nan,1\n0,NA,1,1\ninf,0,0,1\n1,1,\"five\",1\n4,5,6,null\n");
  EXPECT_NE(io_error([&] { read_samples(path, {.coordinates = "x,y", .values = "v"}); }).find("a.csv:7: \"five\""),
            std::string::npos);
  const std::string clean =
      folder.with("b.csv", "x,y,v,w\n1,2,3,\n1,,3,1\n0,0,nan,1\n0,NA,1,1\ninf,0,0,1\n1,1,\"\",1\n4,5,6,null\n");
  const SampleTable samples = read_samples(clean, {.coordinates = "x,y", .values = "v"});
  EXPECT_EQ(samples.coordinates, two_points());
  EXPECT_EQ(samples.values, Eigen::Vector2d(3, 6));
  EXPECT_EQ(samples.dropped, 5);
}

TEST(ReadQueries, FindsCoordinatesByNameOrTakesTheFirst) {
  const TemporaryFolder folder;
  const Names xy{"x", "y"};
  EXPECT_EQ(read_queries(folder.with("a.csv", "y,x\n2,1\n5,4\n"), xy).coordinates, two_points());
  EXPECT_EQ(read_queries(folder.with("b.csv", "lon,lat,name\n1,2,a\n4,5,b\n"), xy).coordinates, two_points());
  EXPECT_EQ(read_queries(folder.with("c.npy", format_npy({{2, 2}, {1, 2, 4, 5}})), xy).coordinates, two_points());
  const Eigen::MatrixXd gap = read_queries(folder.with("d.csv", "4,5\n1,\n"), xy).coordinates;
  ASSERT_EQ(gap.cols(), 2);
  EXPECT_TRUE(std::isnan(gap(1, 1)));
}

TEST(WriteTable, RepeatsCoordinatesInTextAndHoldsValuesInArrays) {
  const TemporaryFolder folder;
  ResultTable table{{"x", "my y"}, {"v"}, two_points(), Eigen::Vector2d(0.1, std::nan(""))};
  write_table(folder.file("a.csv"), table);
  EXPECT_EQ(content(folder.file("a.csv")), "x,my y,v\n1,2,0.1\n4,5,nan\n");
  write_table(folder.file("a.txt"), table);
  EXPECT_EQ(content(folder.file("a.txt")), "# x my_y v\n1 2 0.1\n4 5 nan\n");
  table.values = Eigen::Vector2d(0.1, 7);
  write_table(folder.file("a.npy"), table);
  const NpyArray one = parse_npy(content(folder.file("a.npy")), "a");
  EXPECT_EQ(one.shape, std::vector<Index>{2});
  EXPECT_EQ(one.values, (std::vector<double>{0.1, 7}));
  table.value_names = {"v", "dx"};
  table.values.resize(2, 2);
  table.values << 1, 2, 3, 4;
  write_table(folder.file("b.npy"), table);
  const NpyArray two = parse_npy(content(folder.file("b.npy")), "b");
  EXPECT_EQ(two.shape, (std::vector<Index>{2, 2}));
  EXPECT_EQ(two.values, (std::vector<double>{1, 2, 3, 4}));
  write_table(folder.file("b.csv"), table);
  EXPECT_EQ(read_samples(folder.file("b.csv"), {.coordinates = "x,my_y", .values = "v,dx"}).values, table.values);
}

TEST(ReadSamples, SaysWhatIsWrongAndInWhichLine) {
  const TemporaryFolder folder;
  const auto error = [&](const std::string& name, const std::string& text, const SampleColumns& columns = {}) {
    const std::string path = folder.with(name, text);
    const std::string message = io_error([&] { read_samples(path, columns); });
    return message.starts_with(path) ? message.substr(folder.folder().size() + 1) : message;
  };
  EXPECT_EQ(error("e.csv", ""), "e.csv: the file holds no rows of numbers");
  EXPECT_EQ(error("e.csv", "x,y,v\n"), "e.csv: the file holds column names but no rows of numbers");
  EXPECT_EQ(error("e.csv", "x,y,v\n1,2,3\n4,5\n"), "e.csv:3: expected 3 columns as in line 2, found 2");
  EXPECT_EQ(error("e.csv", "x,y,v\n1,2,3\n4,5,6,7\n"), "e.csv:3: expected 3 columns as in line 2, found 4");
  EXPECT_EQ(error("e.csv", "x,y,v\n1,2,3\n4,five,6\n"), "e.csv:3: \"five\" is not a number (column 2)");
  EXPECT_EQ(error("e.csv", "x,y,v\n1,2,3\n4,five,6\n", {.remedy = "choose others"}),
            "e.csv:3: \"five\" is not a number (column 2); choose others; leave cells without a value empty");
  EXPECT_EQ(error("e.csv", "x,y,v\n1,2,3\n", {.values = "q"}),
            "e.csv: no column is named \"q\"; the columns are \"x\", \"y\", \"v\"");
  EXPECT_EQ(error("e.csv", "1,2,3\n", {.values = "q"}),
            "e.csv: no column is named \"q\"; the columns have no names, give numbers from 1 to 3");
  EXPECT_EQ(error("e.csv", "1,2,3\n", {.values = "4"}), "e.csv: there is no column \"4\"; the file has 3 columns");
  EXPECT_EQ(error("e.csv", "1,2,3\n", {.coordinates = "1,2", .values = "2"}), "e.csv: column \"2\" is used twice");
  EXPECT_EQ(error("e.csv", "1,2,3\n", {.weights = "2,3"}), "e.csv: weights must be one column, found \"2,3\"");
  EXPECT_EQ(error("e.csv", "1,2,3\n1,2,-3\n", {.weights = "3"}),
            "e.csv: row 2 has the weight -3.000000; weights must not be negative");
  EXPECT_EQ(error("e.csv", "1\n2\n"),
            "e.csv: samples need one column of coordinates and one of values at least, the file has only 1");
  EXPECT_EQ(error("e.csv", "1,nan\n,2\n"), "e.csv: no row has a finite number in every column that is used");
  EXPECT_EQ(error("e.npy", format_npy({{3}, {1, 2, 3}})),
            "e.npy: the array has 1 axes or no rows, samples need an (n, d+1) array of one row per sample");
  EXPECT_EQ(error("e.json", "{}"),
            "e.json: unknown extension \".json\"; files of samples are .csv .txt .tsv .dat .xyz .npy .ply .pts "
            ".obj .off .vtp .stl .las .laz .e57 .pcd .ptx");
  EXPECT_EQ(io_error([&] {
              read_queries(folder.with("q.csv", "1\n2\n"), {"x", "y"});
            }),
            folder.file("q.csv") + ": expected 2 coordinates (\"x\", \"y\"), found 1 columns");
}

TEST(WriteTable, RefusesWhatDoesNotFit) {
  const ResultTable table{{"x"}, {"v"}, Eigen::MatrixXd::Zero(1, 3), Eigen::MatrixXd::Zero(2, 1)};
  EXPECT_THROW(write_table("a.csv", table), InvalidInput);
  EXPECT_THROW(write_table("a.csv", {{}, {"v"}, Eigen::MatrixXd::Zero(1, 2), Eigen::MatrixXd::Zero(2, 1)}),
               InvalidInput);
  EXPECT_EQ(io_error([] {
              write_table("a.json", {{"x"}, {"v"}, Eigen::MatrixXd::Zero(1, 2), Eigen::MatrixXd::Zero(2, 1)});
            }),
            "a.json: unknown extension \".json\"; tables of results are .csv .txt .npy, and .gpkg .shp .geojson .fgb");
}

}  // namespace
}  // namespace csrbf::samples_test
