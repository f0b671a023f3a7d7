#include "csrbf/core/error.hpp"
#include "csrbf/core/joined.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/files/text.hpp"
#include "csrbf/io/gdal/gdal.hpp"
#include "csrbf/io/samples.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace csrbf {
namespace {

// The column that tells several lines apart, by its name or else the last one.
Index number_of_line(const SampleSource& source) {
  static const std::array<std::string_view, 12> usual = {"id",      "fid",  "objectid", "line", "line_id", "fault",
                                                         "contour", "part", "number",   "no",   "segment", "index"};
  for (std::size_t c = 0; c < source.names.size(); ++c)
    if (std::find(usual.begin(), usual.end(), lower_case(source.names[c])) != usual.end()) return static_cast<Index>(c);
  return source.values.rows() - 1;
}

// The columns of these names, whether in capitals or not, or the first two, besides the number of the line, where
// there is neither.
std::vector<Index> coordinates_of(const SampleSource& source, const std::vector<std::string>& names,
                                  const std::string& file) {
  std::vector<Index> first_two = {0, 1};
  if (source.values.rows() == 3)
    for (Index& c : first_two) c += c >= number_of_line(source) ? 1 : 0;
  if (names.size() != 2) return first_two;
  std::vector<Index> columns;
  std::string missing;
  for (const std::string& name : names) {
    const auto same = [&](const std::string& other) { return lower_case(other) == lower_case(name); };
    const auto found = std::find_if(source.names.begin(), source.names.end(), same);
    if (found != source.names.end())
      columns.push_back(found - source.names.begin());
    else
      missing = name;
  }
  if (columns.size() == 1)
    throw IoError(file + ": no column is named " + missing + "; the coordinates of the samples are " + joined(names) +
                  ", the columns are " + joined(source.names));
  return columns.empty() ? first_two : columns;
}

std::string column_name(const SampleSource& source, Index column) {
  const auto k = static_cast<std::size_t>(column);
  return "column " + (k < source.names.size() ? source.names[k] : std::to_string(column + 1));
}

}  // namespace

std::vector<Eigen::Matrix2Xd> read_faults(const std::string& path, const std::vector<std::string>& coordinates) {
  if (is_gdal_table(file_extension(path))) {
    const std::vector<Points<2>> lines = read_gdal_lines(path);
    return {lines.begin(), lines.end()};
  }
  const SampleSource source = read_sample_source(path);
  const Eigen::MatrixXd& values = source.values;
  const std::string name = display_name(path);
  const Index columns = values.rows();
  if (columns != 2 && columns != 3)
    throw IoError(name +
                  ": faults need two columns of coordinates and, for several, one with the number of the line; "
                  "found " +
                  std::to_string(columns));
  const std::vector<Index> xy = coordinates_of(source, coordinates, name);
  const Index number_row = 3 - xy[0] - xy[1];
  std::vector<Eigen::Matrix2Xd> faults;
  std::map<double, std::vector<Index>> lines;
  for (Index row = 0; row < values.cols(); ++row) {
    for (Index c = 0; c < columns; ++c)
      if (!std::isfinite(values(c, row)))
        throw IoError(name + ": row " + std::to_string(row + 1) + " has no number in column " + std::to_string(c + 1) +
                      (columns == 3 && c == number_row ? "; lines are told apart by numbers" : ""));
    lines[columns == 3 ? values(number_row, row) : 0].push_back(row);
  }
  for (const auto& [number, rows] : lines) {
    if (rows.size() < 2)
      throw IoError(name + ": the line of row " + std::to_string(rows.front() + 1) + " has one vertex; two are needed" +
                    (columns == 3 ? "; lines are told apart by " + column_name(source, number_row) : ""));
    faults.emplace_back(values(xy, rows));
  }
  return faults;
}

}  // namespace csrbf
