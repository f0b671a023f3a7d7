#include "csrbf/io/contour_lines.hpp"

#include "core/error_testing.hpp"
#include "csrbf/io/polylines.hpp"
#include "io/io_testing.hpp"

#include <Eigen/Geometry>

#include <regex>

namespace csrbf::contour_lines_test {
namespace {

using testing::content;
using testing::io_error;
using testing::TemporaryFolder;

// A square with a square hole; and, when asked, a line of two edges.
ContourLines squares(bool with_open_line = false) {
  ContourLines contours;
  contours.points.resize(2, 11);
  contours.points << 0, 10, 10, 0, 2, 2, 8, 8, 11, 12, 12.5,  //
      0, 0, 10, 10, 2, 8, 8, 2, 1. / 3, 1, 3;
  contours.lines = {{.begin = 0, .size = 4}, {.begin = 4, .size = 4}};
  if (with_open_line)
    contours.lines.push_back({.begin = 8, .size = 3, .closed = false});
  else
    contours.points.conservativeResize(2, 8);
  return contours;
}

struct Drawing {
  std::vector<double> view;
  std::vector<std::string> paths;  // their attributes
};

std::vector<double> numbers_in(const std::string& text) {
  std::vector<double> numbers;
  const std::regex number(R"([-+0-9.]+(e[-+]?[0-9]+)?)");
  for (std::sregex_iterator i(text.begin(), text.end(), number), end; i != end; ++i)
    numbers.push_back(std::stod(i->str()));
  return numbers;
}

Drawing read_svg(const std::string& path) {
  const std::string svg = content(path);
  EXPECT_TRUE(svg.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\" "));
  EXPECT_TRUE(svg.ends_with("</svg>\n"));
  Drawing drawing;
  std::smatch view;
  if (std::regex_search(svg, view, std::regex("viewBox=\"([^\"]*)\""))) drawing.view = numbers_in(view[1]);
  const std::regex element("<path ([^>]*)/>");
  for (std::sregex_iterator i(svg.begin(), svg.end(), element), end; i != end; ++i) drawing.paths.push_back((*i)[1]);
  return drawing;
}

std::string data_of(const std::string& path) {
  std::smatch d;
  return std::regex_search(path, d, std::regex(" d=\"([^\"]*)\"")) ? d[1].str() : "";
}

TEST(ContourFiles, OfTablesAreReadBackAsCurves) {
  const TemporaryFolder folder;
  Eigen::Affine3d placement = Eigen::Affine3d::Identity();
  placement.translate(Point<3>(0.1, -5, 7)).rotate(Eigen::AngleAxisd(0.3, Point<3>::UnitX()));
  for (const bool with_open_line : {false, true}) {
    const ContourLines contours = squares(with_open_line);
    write_contour_lines(folder.file("lines.csv"), contours, {.placement = placement.affine()});
    const Polylines read = read_polylines(folder.file("lines.csv")),
                    expected = to_polylines(contours, placement.affine());
    EXPECT_EQ(read.vertices, expected.vertices) << "all digits";
    EXPECT_EQ(read.edges, expected.edges);
    EXPECT_EQ(read.properties[0].values, expected.properties[0].values);
    EXPECT_EQ(content(folder.file("lines.csv")).starts_with("x,y,z,contour\n"), !with_open_line);
  }
}

TEST(ContourFiles, OfPlyAreReadBackAsCurves) {
  const TemporaryFolder folder;
  const ContourLines contours = squares(true);
  write_contour_lines(folder.file("lines.ply"), contours);
  const Polylines read = read_polylines(folder.file("lines.ply")), expected = to_polylines(contours);
  EXPECT_EQ(read.vertices, expected.vertices.cast<float>().cast<double>());
  EXPECT_EQ(read.edges, expected.edges);
  ASSERT_EQ(read.properties.size(), 1U);
  EXPECT_EQ(read.properties[0].name, "contour");
  EXPECT_EQ(read.properties[0].values, expected.properties[0].values);
}

TEST(ContourFiles, OfDrawingsShowTheWholeImageWithEmptyHoles) {
  const TemporaryFolder folder;
  write_contour_lines(folder.file("a.svg"), squares(), {.view = {Point<2>(-0.5, -0.5), Point<2>(19.5, 11.5)}});
  const Drawing drawing = read_svg(folder.file("a.svg"));
  EXPECT_EQ(drawing.view, (std::vector<double>{-0.5, -0.5, 20, 12}));
  ASSERT_EQ(drawing.paths.size(), 1U) << "one path, or the hole would not be empty";
  EXPECT_NE(drawing.paths[0].find("fill-rule=\"evenodd\""), std::string::npos);
  EXPECT_EQ(data_of(drawing.paths[0]), "\nM0 0L10 0 10 10 0 10Z\nM2 2L2 8 8 8 8 2Z\n");
}

TEST(ContourFiles, OfDrawingsLeaveOpenLinesOpen) {
  const TemporaryFolder folder;
  write_contour_lines(folder.file("a.svg"), squares(true));
  const Drawing drawing = read_svg(folder.file("a.svg"));
  ASSERT_EQ(drawing.paths.size(), 2U);
  EXPECT_NE(drawing.paths[1].find("fill=\"none\""), std::string::npos);
  EXPECT_EQ(data_of(drawing.paths[1]), "\nM11 0.333333333L12 1 12.5 3\n");
  // 2 % of the longest side around the box of the points.
  EXPECT_EQ(drawing.view, (std::vector<double>{-0.25, -0.25, 13, 10.5}));
}

TEST(ContourFiles, MayHoldNoLine) {
  const TemporaryFolder folder;
  write_contour_lines(folder.file("a.svg"), {});
  EXPECT_TRUE(read_svg(folder.file("a.svg")).paths.empty());
  EXPECT_EQ(read_svg(folder.file("a.svg")).view, (std::vector<double>{0, 0, 1, 1}));
  write_contour_lines(folder.file("a.csv"), {});
  EXPECT_EQ(content(folder.file("a.csv")), "x,y,z,contour\n");
  write_contour_lines(folder.file("a.ply"), {});
  EXPECT_EQ(folder.files(), 3);
}

TEST(ContourFiles, AreWrittenOnlyWhenTheyCanBe) {
  const TemporaryFolder folder;
  EXPECT_EQ(io_error([] { write_contour_lines("a.stl", squares()); }),
            "a.stl: unknown extension \".stl\"; contours in the plane are .svg .csv .ply .vtp");
  EXPECT_NE(io_error([&] { write_contour_lines(folder.file("no/a.svg"), squares()); }), "no exception");
  ContourLines broken = squares();
  broken.lines[1].size = 5;
  EXPECT_EQ(invalid_input_message([&] { write_contour_lines(folder.file("a.csv"), broken); }),
            "write_contour_lines: end of a line = 9: must not be beyond the points");
  const ContourFileOptions flat{.view = {Point<2>(0, 0), Point<2>(1, 0)}};
  EXPECT_EQ(
      invalid_input_message([&] { write_contour_lines(folder.file("a.svg"), squares(), flat); }),
      "write_contour_lines: view = 1 x 0: must have positive, finite extent along both axes; leave it out for that "
      "of the points");
  EXPECT_EQ(folder.files(), 0);
}

TEST(ContourFiles, AreKnownByTheirExtension) {
  for (const char* name : {"a.svg", "a.csv", "a.ply", "A.SVG"}) EXPECT_TRUE(is_contour_lines_file(name)) << name;
  for (const char* name : {"a.stl", "a", "svg"}) EXPECT_FALSE(is_contour_lines_file(name)) << name;
}

}  // namespace
}  // namespace csrbf::contour_lines_test
