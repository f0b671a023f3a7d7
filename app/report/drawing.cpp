#include "report/drawing.hpp"

#include "report/html.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

namespace csrbf::app {
namespace {

constexpr double widest_letter = 8;  // pixels
constexpr double rounding = 1e-9;    // tolerance, of a step: above that of doubles, below what can be seen

// 1, 2 or 5 times a power of ten, such that about `count` of them fill the range.
double round_step(double range, int count) {
  const double raw = range / count;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  const double mantissa = raw / power;
  return power * (mantissa < 1.5 ? 1 : mantissa < 3.5 ? 2 : mantissa < 7.5 ? 5 : 10);
}

double letters(const std::string& text) {
  return static_cast<double>(std::count_if(text.begin(), text.end(), [](char c) { return (c & '\xc0') != '\x80'; }));
}

// Ticks whose labels do not meet on an axis of that many pixels.
std::vector<double> labelled_ticks(const Axis& axis, double pixels) {
  constexpr double gap = 6;  // pixels
  double widest = 0;
  for (const double tick : axis.ticks) widest = std::max(widest, widest_letter * letters(axis.text(tick)) + gap);
  const double stride = std::max(1.0, std::ceil(widest / (pixels * axis.step / (axis.hi - axis.lo))));
  std::vector<double> result;
  for (const double tick : axis.ticks)
    if (std::fmod(std::round(tick / axis.step), stride) == 0) result.push_back(tick);
  return result;
}

void set_ticks(Axis& axis) {
  axis.ticks.clear();
  const double first = std::ceil(axis.lo / axis.step - rounding), last = std::floor(axis.hi / axis.step + rounding);
  for (double i = first; i <= last; ++i) axis.ticks.push_back(i * axis.step);
}

}  // namespace

Axis axis(double lo, double hi, std::string label, int count) {
  if (!std::isfinite(lo) || !std::isfinite(hi)) lo = hi = 0;
  // Ticks closer than the rounding of the numbers would never end.
  const double least = 1e-12 * std::max(std::abs(lo), std::abs(hi));
  if (!(hi - lo > least)) {
    const double half = lo == 0 ? 1 : 0.5 * std::abs(lo);
    lo -= half;
    hi += half;
  }
  Axis result{lo, hi, round_step(hi - lo, count), {}, std::move(label)};
  set_ticks(result);
  return result;
}

Axis round_axis(double lo, double hi, std::string label, int count) {
  Axis result = axis(lo, hi, std::move(label), count);
  result.lo = result.step * std::floor(result.lo / result.step + rounding);
  result.hi = result.step * std::ceil(result.hi / result.step - rounding);
  set_ticks(result);
  return result;
}

std::string Axis::text(double tick) const {
  std::array<char, 40> text{};
  const double largest = std::max(std::abs(lo), std::abs(hi));
  constexpr double plain_above = 1e-3, plain_below = 1e6;  // powers of ten elsewhere: labels have room for six digits
  if (std::abs(tick) < rounding * step) return "0";
  if (largest >= plain_below || largest < plain_above) {
    const int digits = std::max(0, static_cast<int>(std::floor(std::log10(std::abs(tick)) + rounding) -
                                                    std::floor(std::log10(step) + rounding)));
    std::snprintf(text.data(), text.size(), "%.*e", digits, tick);
  } else {
    std::snprintf(text.data(), text.size(), "%.*f",
                  std::max(0, -static_cast<int>(std::floor(std::log10(step) + rounding))), tick);
  }
  constexpr double long_number = 1e4;
  const bool is_long = largest < plain_below && std::abs(tick) > (1 - rounding) * long_number;
  return pretty_number(is_long ? grouped(text.data()) : text.data());
}

Drawing::Drawing(Axis x, Axis y, std::string_view description, double width, double height)
    : x_(std::move(x)), y_(std::move(y)), description_(description), width_(width), height_(height) {}

void Drawing::add_text(double x, double y, std::string_view style, std::string_view text) {
  add("<text class=\"" + std::string(style) + "\" x=\"" + coordinate(x) + "\" y=\"" + coordinate(y) + "\">" +
      escaped(text) + "</text>");
}

void Drawing::add_labels() {
  constexpr double gap = 8, half_letter = 4.5, number_line = 17, name_line = 37;  // pixels, by eye
  const double low = top + height_;
  for (const double tick : labelled_ticks(x_, width_)) {
    const std::string text = x_.text(tick);
    constexpr double letter = 7;  // pixels, about
    const double half = letter * letters(text) / 2, end = left + width_ + right;
    add_text(std::min(x(tick), end - half), low + number_line, "tick middle", text);
  }
  for (const double tick : y_.ticks) {
    const std::string text = y_.text(tick);
    more_left_ = std::max(more_left_, widest_letter * letters(text) + gap - left);
    add_text(left - gap, y(tick) + half_letter, "tick end", text);
  }
  if (!x_.label.empty()) add_text(left + width_ / 2, low + name_line, "name middle", x_.label);
  if (!y_.label.empty()) add_text(left - gap, top - gap, "name", y_.label);
}

void Drawing::add_grid() {
  for (const double tick : y_.ticks)
    add("<path class=\"grid\" d=\"M" + coordinate(left) + " " + coordinate(y(tick)) + "h" + coordinate(width_) +
        "\"/>");
  add_labels();
}

void Drawing::add_frame() {
  add("<rect class=\"frame\" x=\"" + coordinate(left) + "\" y=\"" + coordinate(top) + "\" width=\"" +
      coordinate(width_) + "\" height=\"" + coordinate(height_) + "\"/>");
  add_labels();
}

void Drawing::add_mark(double value, const std::string& text) {
  add("<path class=\"mark\" d=\"M" + coordinate(x(value)) + " " + coordinate(top) + "v" + coordinate(height_) + "\"/>");
  const bool to_the_left = x_.at(value) > 0.6;  // leaves the text room to the right of smaller values
  constexpr double gap = 5, line = 12;          // pixels, by eye
  add_text(x(value) + (to_the_left ? -gap : gap), top + line, to_the_left ? "note end" : "note", text);
}

void Drawing::add_color_bar(const Axis& scale, const std::string& address) {
  constexpr double gap = 8, thickness = 9, number_line = 24, more = 56;  // pixels, by eye
  const double low = top + height_ + bottom_ + gap;
  const double from = left + width_ / 8, length = width_ * 3 / 4;
  add("<image href=\"" + address + "\" x=\"" + coordinate(from) + "\" y=\"" + coordinate(low) + "\" width=\"" +
      coordinate(length) + "\" height=\"" + coordinate(thickness) + "\" preserveAspectRatio=\"none\"/>");
  for (const double tick : labelled_ticks(scale, length))
    add_text(from + length * scale.at(tick), low + number_line, "tick middle", scale.text(tick));
  if (!scale.label.empty()) add_text(from + length / 2, low + 2 * number_line - 6, "name middle", scale.label);
  bottom_ += scale.label.empty() ? more - 18 : more;
}

void Drawing::add_line(const PointsRef<2>& points, std::string_view style, bool closed) {
  std::string path;
  bool pen_down = false;
  for (Index i = 0; i < points.cols(); ++i) {
    if (!points.col(i).allFinite()) {
      pen_down = false;
      continue;
    }
    path += (pen_down ? "L" : "M") + coordinate(x(points(0, i))) + " " + coordinate(y(points(1, i)));
    pen_down = true;
  }
  if (path.empty()) return;
  add("<path class=\"" + std::string(style) + "\" d=\"" + path + (closed ? "Z" : "") + "\"/>");
}

void Drawing::add_segments(const PointsRef<2>& ends, std::string_view style) {
  if (ends.cols() == 0) return;
  std::string path;
  for (Index i = 0; i < ends.cols(); ++i)
    path += (i % 2 == 0 ? "M" : "L") + coordinate(x(ends(0, i))) + " " + coordinate(y(ends(1, i)));
  add("<path class=\"" + std::string(style) + "\" d=\"" + path + "\"/>");
}

void Drawing::add_dots(const PointsRef<2>& points, double radius, std::string_view style, const std::string& color) {
  if (points.cols() == 0) return;
  // Lines of zero length with round caps: one short element for all dots.
  std::string path;
  for (Index i = 0; i < points.cols(); ++i)
    if (points.col(i).allFinite()) path += "M" + coordinate(x(points(0, i))) + " " + coordinate(y(points(1, i))) + "h0";
  add("<path class=\"dots " + std::string(style) + "\" style=\"stroke-width:" + coordinate(2 * radius) +
      (color.empty() ? "" : ";stroke:" + color) + "\" d=\"" + path + "\"/>");
}

std::string Drawing::svg() const {
  Json plot = values_;
  plot["x"] = {x_.lo, x_.hi, left, width_, x_.label};
  plot["y"] = {y_.lo, y_.hi, top, height_, y_.label};
  return "<svg data-plot=\"" + escaped(plot.dump(-1, ' ', false, Json::error_handler_t::replace)) + "\" viewBox=\"" +
         coordinate(0 - more_left_) + " 0 " + coordinate(more_left_ + left + width_ + right) + " " +
         coordinate(top + height_ + bottom_) + "\" role=\"img\" aria-label=\"" + escaped(description_) +
         "\" xmlns=\"http://www.w3.org/2000/svg\">\n" + body_ + "</svg>";
}

}  // namespace csrbf::app
