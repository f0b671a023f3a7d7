#pragma once

#include <string>
#include <vector>

/// One line of a drawing, a value for each frame.
struct Curve {
  std::string name, color;
  std::vector<double> values;
};

/// Draws the curves over time as .svg.
void write_svg(const std::string& path, const std::string& title, const std::vector<Curve>& curves);

/// Writes them as .csv: a column each, after the frame.
void write_csv(const std::string& path, const std::vector<Curve>& curves);
