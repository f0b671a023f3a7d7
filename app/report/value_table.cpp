#include "report/value_table.hpp"

#include "report/axis.hpp"
#include "report/html.hpp"
#include "session.hpp"

#include <algorithm>
#include <cstdio>

namespace csrbf::app {
namespace {

constexpr int shown_digits = 4;  // significant; the tooltip has all

bool is_list_of_records(const Json& value) {
  return value.is_array() && !value.empty() && value.front().is_object();
}

std::string row(const std::string& name, const std::string& value) {
  return "<tr><th scope=\"row\">" + name + "</th><td>" + value + "</td></tr>\n";
}

std::string record_table(const std::string& title, const Json& records) {
  std::string head, rows;
  for (const auto& [key, value] : records.front().items()) head += "<th scope=\"col\">" + escaped(words(key)) + "</th>";
  for (const Json& record : records) {
    rows += "<tr>";
    for (const auto& [key, value] : record.items()) rows += "<td>" + value_text(value) + "</td>";
    rows += "</tr>\n";
  }
  return "<div class=\"scroll\"><table class=\"records\">\n<caption>" + escaped(words(title)) +
         "</caption>\n<thead><tr>" + head + "</tr></thead>\n<tbody>\n" + rows + "</tbody></table></div>\n";
}

void add_rows(const std::string& prefix, const Json& part, std::string& rows, std::string& tables) {
  for (const auto& [key, value] : part.items()) {
    const std::string name = prefix.empty() ? key : prefix + ", " + key;
    if (value.is_object())
      add_rows(name, value, rows, tables);
    else if (is_list_of_records(value))
      tables += record_table(name, value);
    else
      rows += row(escaped(words(name)), value_text(value));
  }
}

std::string number_text(const Json& value) {
  if (value.is_number_integer()) {
    std::string text = counted(value.get<Index>(), "");
    text = text.substr(0, text.find(' '));
    return escaped(pretty_number(text));
  }
  return "<span title=\"" + value.dump() + "\">" + escaped(readable(value, shown_digits)) + "</span>";
}

}  // namespace

std::string words(std::string key) {
  std::replace(key.begin(), key.end(), '_', ' ');
  return key;
}

std::string value_text(const Json& value) {
  if (value.is_null()) return "<span class=\"none\">–</span>";
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (value.is_number()) return number_text(value);
  if (value.is_string()) return escaped(value.get<std::string>());
  if (!value.is_array()) return escaped(value.dump());
  constexpr std::size_t many = 8;  // values, that no longer fit a cell
  if (value.empty()) return "<span class=\"none\">–</span>";
  if (value.size() > many) return counted(static_cast<Index>(value.size()), "value");
  std::string text;
  for (const Json& entry : value) text += (text.empty() ? "" : ", ") + value_text(entry);
  return text;
}

std::string value_table(const Json& part) {
  std::string rows, tables;
  add_rows("", part, rows, tables);
  if (!rows.empty())
    rows = "<div class=\"scroll\"><table class=\"values\">\n<tbody>\n" + rows + "</tbody></table></div>\n";
  return rows + tables;
}

std::string seconds_text(double seconds) {
  constexpr double minute = 60;
  if (seconds < 10) return rounded(seconds, seconds < 1 ? 2 : 3) + " s";
  if (seconds < minute) return rounded(std::round(seconds)) + " s";
  const auto whole = static_cast<int>(std::lround(seconds));
  const std::string rest = std::to_string(whole % 60);
  return std::to_string(whole / 60) + ":" + (rest.size() < 2 ? "0" : "") + rest + " min";
}

std::string time_table(const Json& report) {
  const Json& time = report["time"];
  const double total = std::max(time["total"].get<double>(), 1e-3);
  std::string rows;
  for (const auto& [stage, seconds] : time.items()) {
    if (stage == "total") continue;
    const double share = std::min(100 * seconds.get<double>() / total, 100.0);
    rows += "<tr><th scope=\"row\">" + escaped(stage) + "</th><td>" + escaped(seconds_text(seconds)) +
            "</td><td class=\"share\"><svg viewBox=\"0 0 100 6\" preserveAspectRatio=\"none\" aria-hidden=\"true\">"
            "<rect class=\"accent-fill\" width=\"" +
            coordinate(share) + "\" height=\"6\"/></svg></td></tr>\n";
  }
  rows += "<tr class=\"total\"><th scope=\"row\">total</th><td>" + escaped(seconds_text(time["total"])) +
          "</td><td></td></tr>\n";
  return "<table class=\"times\">\n<tbody>\n" + rows + "</tbody></table>\n<p class=\"note\">On " +
         counted(report["threads"].get<Index>(), "thread") + ". Peak memory: " + rounded(report["peak_memory_mb"], 6) +
         " MB.</p>\n";
}

}  // namespace csrbf::app
