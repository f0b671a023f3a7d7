#include "report/tables.hpp"

#include "report/html.hpp"

#include <algorithm>
#include <map>

namespace csrbf::app {
namespace {

constexpr int shown_digits = 4;  // significant; the tooltip has all

bool is_list_of_records(const Json& value) {
  return value.is_array() && !value.empty() && value.front().is_object();
}

std::string number_text(const Json& value) {
  if (value.is_number_integer())
    return "<span class=\"number\">" + escaped(pretty_number(grouped(value.get<Index>()))) + "</span>";
  return "<span class=\"number\" title=\"" + value.dump() + "\">" + escaped(readable(value, shown_digits)) + "</span>";
}

std::string words(std::string key) {
  std::replace(key.begin(), key.end(), '_', ' ');
  return key;
}

// Long names may be broken after these, and nowhere else.
std::string breakable(const std::string& text) {
  std::string result;
  for (const char c : text) {
    result += escaped({&c, 1});
    if (std::string_view("/_-,:").find(c) != std::string_view::npos) result += "<wbr>";
  }
  return result;
}

std::string value_text(const Json& value) {
  if (value.is_null()) return "<span class=\"none\">–</span>";
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (value.is_number()) return number_text(value);
  if (value.is_string()) return breakable(value.get<std::string>());
  if (!value.is_array()) return escaped(value.dump());
  constexpr std::size_t many = 8;  // values, that no longer fit a cell
  if (value.empty()) return "<span class=\"none\">–</span>";
  if (value.size() > many) return counted(std::ssize(value), "value");
  std::string text;
  for (const Json& entry : value) text += (text.empty() ? "" : ", ") + value_text(entry);
  return text;
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
      rows += "<tr><th scope=\"row\">" + escaped(words(name)) + "</th><td>" + value_text(value) + "</td></tr>\n";
  }
}

using Reasons = std::map<std::string, std::string>;

constexpr const char* cross_validation = "predicts held-out points best (cross-validation)";

std::string normals_reason(const std::string& used) {
  if (used == "estimated") return "the file has none: estimated from neighbours and oriented consistently outwards";
  if (used == "corrected")
    return "those of the file, whose errors were corrected by the points and by their neighbours";
  if (used == "re-oriented") return "those of the file, some flipped to agree with the others";
  return "the file has them";
}

Reasons reconstruct_reasons(const Json& options) {
  const std::string method = options.value("method", "");
  Reasons reasons{{"normals", normals_reason(options.value("normals", ""))},
                  {"resolution", "cells as large as the smallest detail that the surface can represent"}};
  if (method != "composite") return reasons;
  reasons["method"] = "suits point clouds of any size";
  for (const char* name : {"smoothing", "leaf_size", "centers_per_patch", "normal_weight"})
    reasons[name] = cross_validation;
  return reasons;
}

std::string fit_method_reason(const Json& options) {
  const std::string method = options.value("method", "");
  if (method == "fixed-budget") return "a number of centres was given";
  if (method == "error-bounded") return "a tolerance was given, which local fits alone do not meet";
  if (method == "interpolate") return "few samples, many variables, or much noise: a single system of equations";
  return options["tolerance"].is_null() ? "many samples: blended local fits"
                                        : "a tolerance was given, which local fits meet";
}

Reasons fit_reasons(const Json& options) {
  const bool one_system = options.value("method", "") == "interpolate";
  return {{"method", fit_method_reason(options)},
          {"kernel", one_system ? "predicts held-out samples best (leave-one-out)" : "the default of the method"},
          {"degree", "chosen together with method and smoothing"},
          {"smoothing", "predicts held-out samples best (cross-validation)"}};
}

std::string shading_reason(const std::string& shading) {
  if (shading == "none") return "the means do not vary over the image enough to matter";
  return shading == "auto" ? "" : "explains most of what constant means leave unexplained";
}

Reasons segment_reasons(const Json& options) {
  const bool edge = options.value("energy", "") == "edge";
  return {
      {"center_spacing", "from the noise of the image: the noisier, the wider"},
      {"support", "the default of the method"},
      {"smoothness", edge ? "contours on edges need it to hold together" : "0, as the centres smooth already"},
      {"window", options.value("window", 0) > 0 ? "separates textures" : "0: keeps details"},
      {"shading", shading_reason(options.value("shading", ""))},
      {"fill_holes", options.value("mode", "") == "local" ? "yes in local mode, whose contour leaves dark spots behind"
                                                          : "only in local mode"}};
}

// Why options that were not given have their values; none for fixed defaults.
Reasons reasons_of(const std::string& subcommand, const Json& options) {
  if (subcommand == "reconstruct") return reconstruct_reasons(options);
  if (subcommand == "fit" || (subcommand == "inpaint" && options.contains("tolerance"))) return fit_reasons(options);
  if (subcommand == "segment" || subcommand == "track") return segment_reasons(options);
  return {};
}

std::string found(const Reasons& reasons, const std::string& name) {
  const auto entry = reasons.find(name);
  return entry == reasons.end() ? "" : entry->second;
}

// The meaning of an option that is chosen automatically and has no flag; empty for others.
std::string option_meaning(const std::string& subcommand, const std::string& option) {
  if (subcommand != "reconstruct") return "";
  return found({{"leaf_size", "largest number of points in a patch"},
                {"overlap", "overlap of neighbouring patches"},
                {"centers_per_patch", "radial basis functions in each patch"},
                {"normal_weight", "weight of the normals relative to the points"}},
               option);
}

std::string rows_table(const std::string& rows) {
  return "<div class=\"scroll\"><table class=\"options\">\n<thead><tr><th scope=\"col\">Option</th><th "
         "scope=\"col\">Value "
         "used</th><th scope=\"col\">Why</th><th scope=\"col\">What it means</th></tr></thead>\n<tbody>\n" +
         rows + "</tbody></table></div>\n";
}

const FlagUse* flag_of(const std::string& option, const std::vector<FlagUse>& flags) {
  std::string name = option;
  std::replace(name.begin(), name.end(), '_', '-');
  const auto found = std::find_if(flags.begin(), flags.end(), [&](const FlagUse& flag) { return flag.name == name; });
  return found == flags.end() ? nullptr : &*found;
}

}  // namespace

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
    if (stage == "total" || stage == "report") continue;
    const double share = std::min(100 * seconds.get<double>() / total, 100.0);
    rows += "<tr><th scope=\"row\">" + escaped(stage) + "</th><td>" + escaped(seconds_text(seconds)) +
            "</td><td class=\"share\"><svg viewBox=\"0 0 100 6\" preserveAspectRatio=\"none\" aria-hidden=\"true\">"
            "<rect class=\"accent-fill\" width=\"" +
            coordinate(share) + "\" height=\"6\"/></svg></td></tr>\n";
  }
  rows += "<tr class=\"total\"><th scope=\"row\">total</th><td>" + escaped(seconds_text(time["total"])) +
          "</td><td></td></tr>\n";
  const std::string page = time.contains("report") ? " This page took " + seconds_text(time["report"]) + " more." : "";
  return "<table class=\"times\">\n<tbody>\n" + rows + "</tbody></table>\n<p class=\"note\">On " +
         counted(report["threads"].get<Index>(), "thread") + ". Peak memory: " + rounded(report["peak_memory_mb"], 6) +
         " MB." + page + "</p>\n";
}

std::string option_table(const Json& report, const std::vector<FlagUse>& flags) {
  std::string rows, defaults;
  Index default_count = 0;
  for (const auto& [option, value] : report["options"].items()) {
    const FlagUse* flag = flag_of(option, flags);
    const bool given = flag != nullptr && flag->given;
    const std::string reason = given ? "" : found(reasons_of(report["command"], report["options"]), option);
    const std::string why = given ? "given" : reason.empty() ? "default" : "chosen: " + reason;
    const char* kind = given ? "given" : reason.empty() ? "default" : "chosen";
    const std::string meaning = flag != nullptr ? flag->what : option_meaning(report["command"], option);
    const bool is_default = !given && reason.empty();
    default_count += is_default ? 1 : 0;
    (is_default ? defaults : rows) += "<tr class=\"" + std::string(kind) + "\"><th scope=\"row\">" +
                                      escaped(words(option)) + "</th><td>" + value_text(value) + "</td><td>" +
                                      escaped(why) + "</td><td class=\"meaning\"><span title=\"" + escaped(meaning) +
                                      "\">" + escaped(meaning) + "</span></td></tr>\n";
  }
  const std::string folded = defaults.empty()
                                 ? ""
                                 : "<details class=\"folded\">\n<summary>" + counted(default_count, "default") +
                                       "</summary>\n" + rows_table(defaults) + "</details>\n";
  return (rows.empty() ? "" : rows_table(rows)) + folded;
}

}  // namespace csrbf::app
