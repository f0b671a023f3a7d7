#include "csrbf/core/error.hpp"
#include "csrbf/io/files/text.hpp"
#include "csrbf/io/geometry/formats.hpp"
#include "csrbf/io/geometry/properties.hpp"

#include <Eigen/Geometry>

namespace csrbf {
namespace {

// The points of all scans, in their common place.
struct PtxPoints {
  std::vector<Point<3>> points;
  std::vector<double> intensity;
  std::vector<Point<3>> colors;  // of every point, or of none
};

void need_line(LineReader& reader, const char* what) {
  if (!reader.next()) reader.fail(std::string("the file ends where ") + what + " should be");
}

template <std::size_t Count>
std::array<double, Count> read_row(const LineReader& reader, const char* what) {
  std::array<double, Count> values{};
  std::string_view rest = reader.line();
  if (count_words(rest) != static_cast<Index>(Count))
    reader.fail(std::string("expected ") + std::to_string(Count) + " numbers: " + what);
  for (double& value : values) value = reader.number(take_word(rest));
  return values;
}

// Ten lines: columns, rows, four of the scanner, four of the matrix that takes points as rows. Returns the number of
// points; reader is at the first of the lines.
Index read_head(LineReader& reader, Eigen::Affine3d& place) {
  constexpr std::int64_t most = index_limit(std::int64_t{1} << 31);  // a limit on damaged files
  const std::int64_t columns = reader.integer(reader.line(), 0, most);
  need_line(reader, "the number of rows");
  const std::int64_t rows = reader.integer(reader.line(), 0, most);
  for (int i = 0; i < 4; ++i) {
    need_line(reader, "the place of the scanner");
    (void)read_row<3>(reader, "the place and the axes of the scanner");
  }
  Eigen::Matrix4d matrix;
  for (int i = 0; i < 4; ++i) {
    need_line(reader, "the matrix of the scan");
    const std::array<double, 4> row = read_row<4>(reader, "a row of the matrix of the scan");
    for (int j = 0; j < 4; ++j) matrix(j, i) = row[static_cast<std::size_t>(j)];
  }
  if (!matrix.allFinite() || !(matrix.row(3) == Eigen::RowVector4d(0, 0, 0, 1)))
    reader.fail("the matrix of the scan is not that of a motion: its last column must be 0 0 0 1");
  place = Eigen::Affine3d(matrix);
  if (!reader.can_hold(columns * rows, 4))
    reader.fail("the scan should have " + std::to_string(columns) + " x " + std::to_string(rows) +
                " points, more than the file can hold");
  return columns * rows;
}

// Points without a return of the laser are 0 0 0.
void read_scan(LineReader& reader, PtxPoints& all) {
  Eigen::Affine3d place;
  const Index count = read_head(reader, place);
  for (Index i = 0; i < count; ++i) {
    if (!reader.next())
      reader.fail("the scan ends after " + std::to_string(i) + " of " + std::to_string(count) + " points");
    std::string_view rest = reader.line();
    const Index words = count_words(rest);
    if (words != 4 && words != 7)
      reader.fail("expected x y z intensity, with red green blue or without, found " + std::to_string(words) +
                  " values");
    std::array<double, 7> v{};
    for (Index k = 0; k < words; ++k) v[static_cast<std::size_t>(k)] = reader.number(take_word(rest));
    if (v[0] == 0 && v[1] == 0 && v[2] == 0) continue;
    all.points.push_back(place * Point<3>(v[0], v[1], v[2]));
    all.intensity.push_back(v[3]);
    if (words == 7) all.colors.emplace_back(v[4], v[5], v[6]);
  }
}

}  // namespace

PointCloud parse_ptx(std::string_view text, const std::string& name) {
  PtxPoints all;
  LineReader reader(text, name);
  if (!reader.next()) throw IoError(name + ": the file is empty");
  do {
    read_scan(reader, all);
  } while (reader.next());
  PointCloud cloud;
  cloud.points.resize(3, std::ssize(all.points));
  for (Index i = 0; i < cloud.size(); ++i) cloud.points.col(i) = all.points[static_cast<std::size_t>(i)];
  cloud.properties.push_back(
      {"intensity", "float", Eigen::Map<const Eigen::VectorXd>(all.intensity.data(), std::ssize(all.intensity))});
  if (cloud.size() > 0 && all.colors.size() == all.points.size()) {
    Eigen::MatrixXd colors(3, cloud.size());
    for (Index i = 0; i < cloud.size(); ++i) colors.col(i) = all.colors[static_cast<std::size_t>(i)];
    constexpr const char* names[] = {"red", "green", "blue"};
    for (Index c = 0; c < 3; ++c)
      cloud.properties.push_back({names[c], "uchar", colors.row(c).transpose().cwiseMax(0).cwiseMin(255)});
  }
  return cloud;
}

}  // namespace csrbf
