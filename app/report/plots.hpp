#pragma once

#include "csrbf/core/image.hpp"
#include "csrbf/implicit/render/color_map.hpp"

#include <string>
#include <vector>

namespace csrbf::app {

/// A marked value on an axis.
struct Mark {
  double value = 0;
  std::string text;
};

/// A histogram as an SVG drawing. Values beyond the axis count in the outermost bars.
struct Histogram {
  std::vector<double> values = {};
  double lo = 0, hi = 1;  ///< of the axis
  std::string label;      ///< of the axis
  std::string counted;    ///< what is counted, plural
  std::vector<Mark> marks = {};
};
std::string draw(const Histogram& histogram);

/// Pairs of values as dots, with a line through means or the line of equal values.
struct Scatter {
  Points<2> dots{2, 0}, line{2, 0};
  std::string x_label = {}, y_label = {};
  bool same_axes = false;  ///< both have the same range, and the line of equal values is drawn
};
std::string draw(const Scatter& scatter);

/// Several distributions over one axis, each in its own colour.
struct Distribution {
  std::string name;
  std::vector<double> counts;  ///< in equal parts of the axis
};
std::string draw(const std::vector<Distribution>& distributions, double lo, double hi, const std::string& label,
                 const std::string& counted);

/// Values at 0, 1, 2, ...: a curve, with dots when they are few.
struct Course {
  std::vector<double> values = {};
  std::string label;    ///< of the values
  std::string counted;  ///< of the numbers
};
std::string draw(const Course& course);

/// Colours for values from lo to hi.
struct ColorScale {
  double lo = 0, hi = 1;
  bool diverging = false;  ///< else sequential
  std::string label = {};

  [[nodiscard]] LinearRgb operator()(double value) const;
};

/// Extends the range from lo to hi by the finite values.
void extend(const Eigen::VectorXd& values, double& lo, double& hi);

/// Evenly spaced colours of a colour map as "#rrggbb".
std::vector<std::string> color_stops(bool diverging);

/// Values on a plane as colours, with segments and dots on top.
struct PlaneMap {
  Eigen::MatrixXd values = {};  ///< columns along x, ascending; rows along y; NaN: none
  Box<2> box = {};
  std::string x_label = {}, y_label = {};
  ColorScale scale = {};
  Points<2> dots{2, 0};
  Eigen::VectorXd dot_values = {};  ///< where they are given, coloured dots are drawn in place of the map
  Points<2> segments{2, 0};         ///< pairs of ends
  bool to_scale = true;             ///< both axes have the same unit
  double width = 410;               ///< of the plot
  std::string description = {};
};
std::string draw(const PlaneMap& map);

/// Drawings side by side.
std::string side_by_side(const std::vector<std::string>& drawings);

/// A function of one variable: a curve through (x, y), and dots.
struct Curve {
  Points<2> line{2, 0}, dots{2, 0};
  std::string x_label = {}, y_label = {};
};
std::string draw(const Curve& curve);

}  // namespace csrbf::app
