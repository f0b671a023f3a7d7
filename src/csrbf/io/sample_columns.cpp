#include "csrbf/io/sample_columns.hpp"

#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/files/text.hpp"

#include <algorithm>
#include <cmath>

namespace csrbf {
namespace {

// Different whole numbers, as those of shuffled rows.
bool are_distinct_whole_numbers(const Table& table, Index column) {
  std::vector<double> numbers;
  for (const double number : table.values.row(column))
    if (std::isfinite(number)) numbers.push_back(number);
  std::sort(numbers.begin(), numbers.end());
  return std::adjacent_find(numbers.begin(), numbers.end()) == numbers.end() &&
         std::all_of(numbers.begin(), numbers.end(), [](double number) { return number == std::round(number); });
}

}  // namespace

bool is_longitude(std::string_view name) {
  return is_listed(lower_case(name), "lon long longitude lng x_lon");
}

bool is_latitude(std::string_view name) {
  return is_listed(lower_case(name), "lat latitude y_lat");
}

bool is_eastward(std::string_view name) {
  return is_longitude(name) || is_listed(lower_case(name), "x easting east");
}

bool is_northward(std::string_view name) {
  return is_latitude(name) || is_listed(lower_case(name), "y northing north");
}

std::string name_of_unnamed(Index column) {
  return "column " + std::to_string(column + 1);
}

bool is_unnamed(const std::string& name, Index column) {
  return name.empty() || name == name_of_unnamed(column) || lower_case(name).starts_with("unnamed: ");
}

bool counts_rows(const Table& table, Index column) {
  const double first = table.values(column, 0);
  bool counts = first == 0 || first == 1;
  for (Index row = 0; counts && row < table.values.cols(); ++row)
    counts = table.values(column, row) == first + static_cast<double>(row);
  return counts;
}

std::string row_number_among(const Table& table, const std::vector<Index>& columns) {
  constexpr std::string_view names = "id fid oid objectid index idx nr no row number point_id pointid station_id gid";
  constexpr Index enough = 5;  // rows
  for (const Index column : columns) {
    const bool has_name = !table.names.empty();
    const std::string name = has_name ? table.names[static_cast<std::size_t>(column)] : "";
    if (has_name && is_listed(lower_case(name), names)) return name;
    if (columns.size() < 2 || table.values.cols() < enough) continue;
    if (has_name && is_listed(lower_case(name), "x y z t time lon lat")) continue;
    const bool is_suspect =
        has_name && is_unnamed(name, column) ? are_distinct_whole_numbers(table, column) : counts_rows(table, column);
    if (is_suspect) return has_name ? name : "number " + std::to_string(column + 1);
  }
  return "";
}

std::string deviation_among(const Table& table, const std::vector<Index>& columns) {
  constexpr std::string_view names =
      "sigma sd std stdev stddev std_dev standard_deviation sem stderr std_err standard_error uncertainty weight "
      "weights";
  for (const Index column : columns)
    if (!table.names.empty() && is_listed(lower_case(table.names[static_cast<std::size_t>(column)]), names))
      return table.names[static_cast<std::size_t>(column)];
  return "";
}

std::string misplaced_value(const Table& table, const std::vector<Index>& coordinates, Index value) {
  if (table.names.empty() || coordinates.size() < 2) return "";
  const std::string& name = table.names[static_cast<std::size_t>(value)];
  const auto partner = [&](Index column) {
    const std::string& other = table.names[static_cast<std::size_t>(column)];
    return (is_northward(name) && is_eastward(other)) || (is_eastward(name) && is_northward(other));
  };
  return std::any_of(coordinates.begin(), coordinates.end(), partner) ? name : "";
}

}  // namespace csrbf
