#pragma once

#include <string>
#include <vector>

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

/// A number for people, with this many significant digits: 52,980, 0.0753, 3.2×10⁻⁶.
std::string readable(double value, int digits = 3);

/// A typographic minus, and powers of ten as 3×10⁻⁵.
std::string pretty_number(const std::string& text);

}  // namespace csrbf::app
