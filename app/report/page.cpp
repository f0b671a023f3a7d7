#include "report/page.hpp"

#include "report/html.hpp"
#include "report/page_files.hpp"
#include "report/tables.hpp"

#include <algorithm>
#include <filesystem>

namespace csrbf::app {
namespace {

// Makes the browser refuse to load anything from elsewhere.
constexpr std::string_view policy =
    "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'";

std::string element(std::string_view name, const std::string& content) {
  return "<" + std::string(name) + ">" + content + "</" + std::string(name) + ">\n";
}

std::string section(const std::string& title, const std::string& content) {
  if (content.empty()) return "";
  std::string id = title;
  std::transform(id.begin(), id.end(), id.begin(), [](char c) { return c == ' ' ? '-' : static_cast<char>(c | ' '); });
  return "<section id=\"" + id + "\">\n<h2>" + escaped(title) + "</h2>\n" + content + "</section>\n";
}

std::string file_name(const Json& path) {
  return path.is_string() ? std::filesystem::path(path.get<std::string>()).filename().string() : "";
}

std::string input_name(const Json& report) {
  const Json& input = report["input"];
  if (input.contains("a") && input.contains("b"))
    return file_name(input["a"].value("file", Json())) + " and " + file_name(input["b"].value("file", Json()));
  for (const char* key : {"file", "first", "files", "inputs"})
    if (input.contains(key)) return input[key].is_array() ? file_name(input[key].front()) : file_name(input[key]);
  return "";
}

std::string heading(const Json& report) {
  const std::string from = input_name(report), to = file_name(report["options"].value("output", Json()));
  std::string text = from;
  if (!to.empty()) text += (text.empty() ? "" : " → ") + to;
  return text.empty() ? report["command"].get<std::string>() : text;
}

std::string warnings(const Json& report) {
  std::string items;
  for (const Json& warning : report["warnings"]) items += element("li", escaped(warning.get<std::string>()));
  if (items.empty()) return "";
  return "<section id=\"warnings\" class=\"warnings\">\n<h2>Warnings</h2>\n<ul>\n" + items + "</ul>\n</section>\n";
}

std::string facts(const Json& report, const Page& page) {
  std::vector<Fact> all = page.facts;
  all.push_back({seconds_text(report["time"]["total"]), "time"});
  all.push_back({rounded(report["peak_memory_mb"], 3) + " MB", "peak memory"});
  std::string items;
  for (const Fact& fact : all)
    items += "<div><dd>" + escaped(fact.value) + "</dd><dt>" + escaped(fact.label) + "</dt></div>\n";
  return "<dl class=\"facts\">\n" + items + "</dl>\n";
}

std::string summary_text(const Page& page, const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& finding : page.findings) text += element("p", escaped(finding));
  if (!text.empty()) return text;
  for (const std::string& line : lines) text += element("li", escaped(line));
  return text.empty() ? "" : "<ul class=\"lines\">\n" + text + "</ul>\n";
}

// The summary follows the first picture, which the first screen is for.
std::string figures(const Page& page, const std::string& summary) {
  const std::string words = summary.empty() ? "" : "<div class=\"panel wide summary\">\n" + summary + "</div>\n";
  std::string text;
  const bool picture_first = !page.figures.empty() && page.figures.front().wide;
  if (!picture_first) text += words;
  for (const Figure& figure : page.figures) {
    if (picture_first && &figure == &page.figures.front() + 1) text += words;
    text += std::string("<div class=\"panel") + (figure.wide ? " wide" : "") + "\">\n<h2>" + escaped(figure.title) +
            "</h2>\n" + figure.body + "\n";
    if (!figure.caption.empty()) text += "<p class=\"caption\">" + escaped(figure.caption) + "</p>\n";
    text += "</div>\n";
  }
  if (picture_first && page.figures.size() == 1) text += words;
  return text.empty() ? "" : "<div class=\"panels\">\n" + text + "</div>\n";
}

std::string details(const std::string& title, const std::string& text) {
  return "<details class=\"more\">\n<summary>" + escaped(title) + "</summary>\n<pre>" + escaped(text) +
         "</pre>\n</details>\n";
}

}  // namespace

std::string html_page(const Json& report, const CommonOptions& common, const std::vector<std::string>& summary,
                      const Page& page) {
  const std::string subcommand = report["command"], title = heading(report);
  const bool has_surface = std::any_of(page.figures.begin(), page.figures.end(), [](const Figure& figure) {
    return figure.body.find("surface-data") != std::string::npos;
  });
  std::string html = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n";
  html += "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
  html += "<meta name=\"color-scheme\" content=\"light dark\">\n";
  html += "<meta http-equiv=\"Content-Security-Policy\" content=\"" + std::string(policy) + "\">\n";
  html += "<title>" + escaped(title) + " · csrbf " + escaped(subcommand) + "</title>\n";
  html += "<style>\n" + std::string(page_style) + "</style>\n</head>\n<body>\n<header>\n<p class=\"command\">csrbf " +
          escaped(subcommand) + "</p>\n<h1>" + escaped(title) + "</h1>\n</header>\n<main>\n";
  html += facts(report, page) + warnings(report);
  html += figures(page, summary_text(page, summary));
  html += section("Options", option_table(report, common.flags));
  html += "<div class=\"columns\">\n" + section("Results", value_table(report["result"])) + "<div>\n" +
          section("Time and memory", time_table(report)) + section("Input", value_table(report["input"])) +
          "</div>\n</div>\n";
  html += section("Command", "<pre class=\"command\">" + escaped(common.command) + "</pre>\n");
  const std::string json = report.dump(2, ' ', false, Json::error_handler_t::replace);
  html += details("The report as JSON", json) + details("Licences", std::string(page_licence));
  html += "</main>\n<footer>Made by csrbf " + escaped(report["csrbf"].get<std::string>()) +
          ". This file needs no network and no other file.</footer>\n";
  html += "<script type=\"application/json\" id=\"report\">" + script_text(report) + "</script>\n";
  const std::string_view script = has_surface ? page_script : page_plots_script;
  if (!script.empty() && !page.figures.empty()) html += "<script>\n" + std::string(script) + "</script>\n";
  return html + "</body>\n</html>\n";
}

}  // namespace csrbf::app
