#pragma once

#include "common.hpp"

namespace csrbf::app {

/// A headline figure.
struct Fact {
  std::string value;
  std::string label;
};

/// A plot or picture, as HTML, with its title and what it shows (plain text).
struct Figure {
  std::string title;
  std::string body;
  std::string caption;
  bool wide = false;  ///< takes the whole width of the page
};

/// What a command adds to its HTML report.
struct Page {
  std::vector<Fact> facts;
  std::vector<std::string> findings;  ///< sentences in plain words
  std::vector<Figure> figures;
};

/// One HTML file that needs nothing else: no network, no other file. The JSON report is in it as well. `common`: the
/// command as typed and its flags; `summary`: the lines shown on the terminal; `page`: what the command adds.
std::string html_page(const Json& report, const CommonOptions& common, const std::vector<std::string>& summary,
                      const Page& page);

}  // namespace csrbf::app
