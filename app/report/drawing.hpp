#pragma once

#include "common.hpp"

#include <string_view>

namespace csrbf::app {

/// One axis of a plot, with ticks at round numbers.
struct Axis {
  double lo = 0, hi = 1;
  double step = 1;  ///< between ticks
  std::vector<double> ticks;
  std::string label;

  /// Where a value lies: 0 at lo, 1 at hi.
  [[nodiscard]] double at(double value) const { return (value - lo) / (hi - lo); }
  /// A tick as a number with the digits it needs.
  [[nodiscard]] std::string text(double tick) const;
};

/// Axis from lo to hi, with about `count` ticks between them. A range that is empty or not finite is replaced by one
/// around its middle (or 0).
Axis axis(double lo, double hi, std::string label, int count = 5);

/// The same, its ends moved outwards to ticks.
Axis round_axis(double lo, double hi, std::string label, int count = 5);

/// An SVG drawing with two axes. Colours come from the style sheet of the page (as classes), so that drawings follow
/// its light and dark theme.
class Drawing {
 public:
  /// The plot area is `width` x `height`; labels go around it.
  Drawing(Axis x, Axis y, std::string_view description, double width = default_width, double height = default_height);

  static constexpr double default_width = 410, default_height = 200;  ///< pixels: two plots side by side on a page

  [[nodiscard]] double x(double value) const { return left + width_ * x_.at(value); }
  [[nodiscard]] double y(double value) const { return top + height_ * (1 - y_.at(value)); }
  [[nodiscard]] double width() const { return width_; }

  /// Lines across the plot at the ticks of y, with tick labels and names along both axes.
  void add_grid();
  /// A frame, with tick labels and names along both axes: for pictures that fill the plot.
  void add_frame();
  void add(const std::string& element) { body_ += element + "\n"; }
  void add_text(double x, double y, std::string_view style, std::string_view text);
  /// A dashed line across the plot at x = value, with its text on top.
  void add_mark(double value, const std::string& text);
  /// A colour bar with tick labels under the plot; `address` is a picture of the colours.
  void add_color_bar(const Axis& scale, const std::string& address);
  /// A polyline.
  void add_line(const PointsRef<2>& points, std::string_view style, bool closed = false);
  /// Lines between pairs of points, in one path.
  void add_segments(const PointsRef<2>& ends, std::string_view style);
  void add_dots(const PointsRef<2>& points, double radius, std::string_view style, const std::string& color = {});
  /// What the page tells under the cursor besides curves and dots (viewer/src/hover.js): "bars" or "map".
  void add_values(const std::string& name, const Json& values) { values_[name] = values; }

  [[nodiscard]] std::string svg() const;

  static constexpr double left = 58, right = 14, top = 22, below = 44;  ///< margins for the labels, pixels

 private:
  void add_labels();

  Axis x_, y_;
  std::string description_, body_;
  Json values_ = Json::object();
  double width_, height_, bottom_ = below, more_left_ = 0;  // beyond the margin, for long labels
};

}  // namespace csrbf::app
