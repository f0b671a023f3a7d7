#pragma once

#include <string>
#include <utility>
#include <vector>

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

}  // namespace csrbf::app
