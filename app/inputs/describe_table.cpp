#include "inputs/describe_table.hpp"

#include "csrbf/core/joined.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace csrbf::app {
namespace {

struct Column {
  std::string name;
  Index missing = 0;
  double lo = std::numeric_limits<double>::infinity(), hi = -std::numeric_limits<double>::infinity();

  [[nodiscard]] bool is_empty() const { return !(lo <= hi); }
};

Column column_of(const SampleSource& source, Index c) {
  Column column{c < std::ssize(source.names) ? source.names[static_cast<std::size_t>(c)] : std::to_string(c + 1)};
  for (const double value : source.values.row(c)) {
    if (!std::isfinite(value)) {
      ++column.missing;
      continue;
    }
    column.lo = std::min(column.lo, value);
    column.hi = std::max(column.hi, value);
  }
  return column;
}

std::string names_of(const SampleSource& source, const std::vector<Index>& columns) {
  std::vector<std::string> names;
  for (const Index c : columns)
    names.push_back(source.names.empty() ? "column " + std::to_string(c + 1)
                                         : source.names[static_cast<std::size_t>(c)]);
  return joined(names);
}

}  // namespace

std::string short_crs(const std::string& crs) {
  const std::size_t begin = crs.find('"'), end = crs.find('"', begin + 1);
  return begin == std::string::npos || end == std::string::npos ? crs : crs.substr(begin, end + 1 - begin);
}

void report_table(const SampleSource& source, Session& session) {
  constexpr Index most_lines = 6;  // of the summary; the report has all columns
  const Index rows = source.values.cols(), count = source.values.rows();
  session.result = {{"kind", "table"}, {"rows", rows}, {"columns", Json::array()}, {"crs", or_null(source.crs)}};
  session.say("table:       " + counted(rows, "row") + " of " + counted(count, "column") +
              (source.crs.empty() ? "" : ", on a map: " + short_crs(source.crs)));
  for (Index c = 0; c < count; ++c) {
    const Column column = column_of(source, c);
    session.result["columns"].push_back({{"name", column.name},
                                         {"min", or_null(!column.is_empty(), column.lo)},
                                         {"max", or_null(!column.is_empty(), column.hi)},
                                         {"missing", column.missing}});
    if (c >= most_lines) continue;
    session.say("  " + column.name + ": " +
                (column.is_empty() ? "no numbers" : "from " + rounded(column.lo, 7) + " to " + rounded(column.hi, 7)) +
                (column.missing > 0 && !column.is_empty() ? ", " + grouped(column.missing) + " missing" : ""));
  }
  if (count > most_lines) session.say("  and " + counted(count - most_lines, "more column") + " (all in the report)");
  if (count < 2) return;
  std::vector<Index> refused;
  for (const Index c : source.text)
    for (const auto* used : {&source.coordinates, &source.columns})
      if (std::find(used->begin(), used->end(), c) != used->end()) refused.push_back(c);
  session.result["coordinates"] = names_of(source, source.coordinates);
  session.result["value"] = names_of(source, source.columns);
  if (!refused.empty())
    return session.say("csrbf fit needs --coordinates and --values: by default it takes all columns, and " +
                       names_of(source, refused) + (refused.size() > 1 ? " hold text" : " holds text"));
  session.say("csrbf fit takes " + names_of(source, source.coordinates) + " for coordinates and " +
              names_of(source, source.columns) + " for the value");
}

}  // namespace csrbf::app
