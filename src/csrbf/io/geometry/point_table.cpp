#include "csrbf/io/geometry/formats.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/column_picker.hpp"
#include "csrbf/io/files/table.hpp"
#include "csrbf/io/files/text.hpp"
#include "csrbf/io/geometry/properties.hpp"
#include "csrbf/io/sample_columns.hpp"

namespace csrbf {
namespace {

constexpr std::array<std::string_view, 3> position_names{"x", "y", "z"};
constexpr std::array<std::string_view, 3> normal_names{"nx", "ny", "nz"};
constexpr std::array<std::string_view, 3> color_names{"red", "green", "blue"};

// True when the columns have length 1 or, where they are missing, 0, and some component is negative: normals.
bool are_unit_normals(const Eigen::Ref<const Eigen::MatrixXd>& columns) {
  constexpr double rounding = 0.01;  // of normals with two decimals
  Index units = 0;
  for (const auto& column : columns.colwise()) {
    const double length = column.norm();
    if (std::abs(length - 1) <= rounding)
      ++units;
    else if (length > 0)
      return false;
  }
  return 2 * units > columns.cols() && (columns.array() < 0).any();
}

// Names for a table that has none: x y z, then normals, colours and further columns according to their number.
std::vector<std::string> guessed_names(const Table& table) {
  const Index columns = table.values.rows();
  std::vector<std::string> names(position_names.begin(), position_names.end());
  const auto add = [&](const std::array<std::string_view, 3>& more) {
    names.insert(names.end(), more.begin(), more.end());
  };
  const auto colors_at = [&](Index row) { return are_whole_colors(table.values.middleRows(row, 3)); };
  if (columns == 6) add(colors_at(3) ? color_names : normal_names);
  if (columns == 7 && colors_at(4)) {
    names.emplace_back("intensity");
    add(color_names);
  }
  if (columns == 9) {
    const bool colors_first = colors_at(3);
    add(colors_first ? color_names : normal_names);
    add(colors_first ? normal_names : color_names);
  }
  const auto has_normals = [&] { return std::find(names.begin(), names.end(), normal_names[0]) != names.end(); };
  while (std::ssize(names) < columns) {
    const Index at = std::ssize(names);
    if (at + 3 <= columns && !has_normals() && are_unit_normals(table.values.middleRows(at, 3)))
      add(normal_names);
    else
      names.push_back("column_" + std::to_string(at + 1));
  }
  return names;
}

class Columns {
 public:
  Columns(const Table& table, const std::string& file) : table_(table) {
    names_ = table.names;
    standardize_names(names_);
    if (names_.empty() || (table.names_from_comment && !has_all(position_names))) {
      if (table.values.rows() < 3)
        throw IoError(file + ":" + std::to_string(table.first_line) + ": expected 3 coordinates, found " +
                      std::to_string(table.values.rows()));
      names_ = guessed_names(table);
    }
    for (const std::string_view axis : position_names)
      if (index_of(axis) < 0)
        throw IoError(file + ": no column is named " + in_quotes(axis) + "; the columns are " + listed(table.names) +
                      (has_degrees()
                           ? ": longitudes and latitudes are angles, convert them to lengths, as by gdaltransform"
                           : ": rename those of the coordinates to x, y and z"));
    used_.assign(names_.size(), false);
  }

  [[nodiscard]] bool has_all(const std::array<std::string_view, 3>& names) const {
    return std::all_of(names.begin(), names.end(), [&](std::string_view n) { return index_of(n) >= 0; });
  }

  Points<3> take(const std::array<std::string_view, 3>& names) {
    Points<3> rows(3, table_.values.cols());
    for (int i = 0; i < 3; ++i) {
      const Index column = index_of(names[i]);
      rows.row(i) = table_.values.row(column);
      used_[column] = true;
    }
    return rows;
  }

  void take_rest(std::vector<Property>& properties) const {
    for (Index i = 0; i < std::ssize(names_); ++i)
      if (!used_[i]) properties.push_back({names_[i], "float", table_.values.row(i).transpose()});
  }

 private:
  [[nodiscard]] bool has_degrees() const {
    return std::any_of(names_.begin(), names_.end(), is_longitude) &&
           std::any_of(names_.begin(), names_.end(), is_latitude);
  }

  [[nodiscard]] Index index_of(std::string_view name) const {
    const auto found = std::find(names_.begin(), names_.end(), name);
    return found == names_.end() ? -1 : found - names_.begin();
  }

  const Table& table_;
  std::vector<std::string> names_;
  std::vector<bool> used_;
};

}  // namespace

PointCloud parse_point_table(std::string_view text, const std::string& name) {
  const Table table = parse_table(text, name);
  Columns columns(table, name);
  PointCloud cloud;
  cloud.points = columns.take(position_names);
  if (columns.has_all(normal_names)) cloud.normals = columns.take(normal_names);
  if (columns.has_all(color_names)) add_colors(columns.take(color_names), cloud.properties);
  columns.take_rest(cloud.properties);
  return cloud;
}

std::string format_point_table(const PointCloud& cloud, TableStyle style) {
  const bool named = style == TableStyle::txt || style == TableStyle::csv;
  const Index properties = named ? std::ssize(cloud.properties) : 0;
  const Index fixed = cloud.has_normals() ? 6 : 3;
  Eigen::MatrixXd values(fixed + properties, cloud.size());
  values.topRows(3) = cloud.points;
  if (cloud.has_normals()) values.middleRows(3, 3) = cloud.normals;
  std::vector<std::string> names(position_names.begin(), position_names.end());
  if (cloud.has_normals()) names.insert(names.end(), normal_names.begin(), normal_names.end());
  for (Index p = 0; p < properties; ++p) {
    values.row(fixed + p) = cloud.properties[p].values.transpose();
    names.push_back(cloud.properties[p].name);
  }
  if (!named) names.clear();
  const std::string count = style == TableStyle::pts ? std::to_string(cloud.size()) + "\n" : "";
  return count +
         format_table(names, values, style == TableStyle::csv ? ',' : ' ', style == TableStyle::txt ? "# " : "");
}

}  // namespace csrbf
