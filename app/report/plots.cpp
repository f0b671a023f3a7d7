#include "report/plots.hpp"

#include "report/drawing.hpp"
#include "report/html.hpp"

#include <algorithm>
#include <cmath>

namespace csrbf::app {
namespace {

constexpr int series_colors = 6;        // of the style sheet
constexpr double scatter_height = 300;  // pixels, of plots whose axes have the same scale

// The colours as a picture, `width` of them from low to high.
std::string bar_address(const ColorScale& scale) {
  constexpr int width = 128;  // shades: bands are not visible
  RgbImage bar(width, 1);
  for (int i = 0; i < width; ++i) {
    const LinearRgb color = scale(scale.lo + (scale.hi - scale.lo) * i / (width - 1));
    for (int c = 0; c < 3; ++c)
      bar.pixels[3 * i + c] = static_cast<std::uint8_t>(std::lround(255 * srgb_from_linear(color[c])));
  }
  return png_address(bar);
}

// #rrggbb.
std::string hex_color(const LinearRgb& color) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string text = "#";
  for (int c = 0; c < 3; ++c) {
    const auto byte = static_cast<unsigned>(std::lround(255 * srgb_from_linear(color[c])));
    text += {digits[byte >> 4U], digits[byte & 15U]};
  }
  return text;
}

std::string picture_address(const Eigen::MatrixXd& values, const ColorScale& scale) {
  constexpr std::uint8_t none = 160;  // grey of undefined values
  RgbImage picture(static_cast<int>(values.cols()), static_cast<int>(values.rows()));
  std::uint8_t* out = picture.pixels.data();
  for (Index row = values.rows() - 1; row >= 0; --row)
    for (Index column = 0; column < values.cols(); ++column) {
      const double value = values(row, column);
      const LinearRgb color = scale(value);
      for (int c = 0; c < 3; ++c)
        *out++ = std::isnan(value) ? none : static_cast<std::uint8_t>(std::lround(255 * srgb_from_linear(color[c])));
    }
  return png_address(picture);
}

// Each value as a short line under the axis, when they are few enough to be told apart.
void add_rug(const std::vector<double>& values, const Axis& x, Drawing& drawing) {
  constexpr std::size_t most = 500;
  if (values.size() > most) return;
  std::string path;
  for (const double value : values)
    if (value >= x.lo && value <= x.hi)
      path += "M" + coordinate(drawing.x(value)) + " " + coordinate(drawing.y(0)) + "v5";
  if (!path.empty()) drawing.add("<path class=\"rug\" d=\"" + path + "\"/>");
}

// Values of a map in bytes for the page to tell: 0 to 254 along the scale, 255 where there is none; rows from below.
Json map_values(const PlaneMap& map) {
  constexpr double most = 254;
  std::string bytes;
  for (Index row = 0; row < map.values.rows(); ++row)
    for (const double value : map.values.row(row)) {
      const double t = std::clamp((value - map.scale.lo) / (map.scale.hi - map.scale.lo), 0.0, 1.0);
      bytes += std::isfinite(value) ? static_cast<char>(static_cast<unsigned char>(std::lround(most * t))) : '\xff';
    }
  return {{"columns", map.values.cols()}, {"rows", map.values.rows()}, {"lo", map.scale.lo},
          {"hi", map.scale.hi},           {"label", map.scale.label},  {"values", base64(bytes)}};
}

// Dots with the colours of their values, on a line that sets pale ones apart.
void add_colored_dots(const PlaneMap& map, Drawing& drawing) {
  constexpr int shades = 32;
  constexpr double radius = 3, outline = 3.8;  // pixels
  std::vector<std::vector<Index>> of_shade(shades);
  for (Index i = 0; i < map.dots.cols(); ++i) {
    if (!std::isfinite(map.dot_values[i])) continue;
    const double t = std::clamp((map.dot_values[i] - map.scale.lo) / (map.scale.hi - map.scale.lo), 0.0, 1.0);
    of_shade[static_cast<std::size_t>(std::lround(t * (shades - 1)))].push_back(i);
  }
  drawing.add_dots(map.dots, outline, "outline");
  for (int shade = 0; shade < shades; ++shade) {
    const double t = shade / (shades - 1.0);
    const std::string color = hex_color(map.scale(map.scale.lo + t * (map.scale.hi - map.scale.lo)));
    drawing.add_dots(map.dots(Eigen::all, of_shade[static_cast<std::size_t>(shade)]), radius, "", color);
  }
}

}  // namespace

std::string draw(const Scatter& scatter) {
  double lo = std::numeric_limits<double>::infinity(), hi = -lo;
  extend(scatter.dots.row(0), lo, hi);
  if (scatter.same_axes) extend(scatter.dots.row(1), lo, hi);
  double bottom = lo, top = hi;
  if (!scatter.same_axes) {
    bottom = std::numeric_limits<double>::infinity(), top = -bottom;
    extend(scatter.dots.row(1), bottom, top);
  }
  Drawing drawing(axis(lo, hi, scatter.x_label), axis(bottom, top, scatter.y_label, 4),
                  scatter.y_label + " by " + scatter.x_label, Drawing::default_width,
                  scatter.same_axes ? scatter_height : Drawing::default_height);
  drawing.add_grid();
  if (scatter.same_axes) drawing.add_line(Points<2>{{lo, hi}, {lo, hi}}, "diagonal");
  constexpr Index many = 800;  // dots, from which they are smaller
  drawing.add_dots(scatter.dots, scatter.dots.cols() > many ? 1.1 : 1.8, "accent dim");
  if (scatter.line.cols() > 0) drawing.add_line(scatter.line, "curve");
  return drawing.svg();
}

std::string draw(const Histogram& histogram) {
  constexpr int bins = 40;  // ten pixels each
  const Axis x = axis(histogram.lo, histogram.hi, histogram.label);
  std::vector<double> count(bins, 0);
  for (const double value : histogram.values) {
    if (std::isnan(value)) continue;
    const double place = std::clamp(std::floor(bins * x.at(value)), 0.0, bins - 1.0);
    ++count[static_cast<std::size_t>(place)];
  }
  const double most = *std::max_element(count.begin(), count.end());
  Drawing drawing(x, round_axis(0, std::max(most, 1.0), histogram.counted, 4),
                  "Histogram: " + histogram.counted + " by " + histogram.label);
  drawing.add_grid();
  const double width = drawing.width() / bins;
  std::string path;
  for (int i = 0; i < bins; ++i) {
    const double height = drawing.y(0) - drawing.y(count[i]);
    if (height > 0)
      path += "M" + coordinate(Drawing::left + i * width + 0.5) + " " + coordinate(drawing.y(0)) + "v" +
              coordinate(-height) + "h" + coordinate(width - 1) + "v" + coordinate(height) + "z";
  }
  drawing.add("<path class=\"bars\" d=\"" + path + "\"/>");
  drawing.add_values("bars", count);
  add_rug(histogram.values, x, drawing);
  for (const Mark& mark : histogram.marks)
    if (mark.value >= x.lo && mark.value <= x.hi) drawing.add_mark(mark.value, mark.text);
  return drawing.svg();
}

std::string draw(const std::vector<Distribution>& distributions, double lo, double hi, const std::string& label,
                 const std::string& counted) {
  double most = 1;
  for (const Distribution& d : distributions)
    most = std::max(most, *std::max_element(d.counts.begin(), d.counts.end()));
  Drawing drawing(axis(lo, hi, label), round_axis(0, most, counted, 4), "Histograms: " + counted + " by " + label);
  drawing.add_grid();
  // The legend is on the side that the curves leave free.
  const auto highest = [&](bool at_left) {
    double result = 0;
    for (const Distribution& d : distributions) {
      const auto third = std::ssize(d.counts) / 3;
      const auto begin = at_left ? d.counts.begin() : d.counts.end() - third;
      result = std::max(result, third > 0 ? *std::max_element(begin, begin + third) : 0);
    }
    return result;
  };
  const bool is_left = highest(true) < highest(false);
  for (std::size_t i = 0; i < distributions.size(); ++i) {
    const std::vector<double>& counts = distributions[i].counts;
    const Index n = std::ssize(counts);
    Points<2> steps(2, 2 * n + 2);
    steps.col(0) << lo, 0;
    for (Index k = 0; k < n; ++k) {
      const double width = (hi - lo) / static_cast<double>(n), from = lo + width * static_cast<double>(k);
      steps.col(2 * k + 1) << from, counts[k];
      steps.col(2 * k + 2) << from + width, counts[k];
    }
    steps.col(2 * n + 1) << hi, 0;
    const std::string series = "series" + std::to_string(i % series_colors);
    drawing.add_line(steps, "area " + series, true);
    constexpr double line = 17, key_width = 14;  // of the legend, pixels
    const double y = Drawing::top + 12 + line * static_cast<double>(i);
    const double x = Drawing::left + (is_left ? 10 : drawing.width() - 10 - key_width);
    drawing.add("<path class=\"key " + series + "\" d=\"M" + coordinate(x) + " " + coordinate(y - 4) + "h" +
                coordinate(key_width) + "\"/>");
    drawing.add_text(is_left ? x + key_width + 6 : x - 6, y, is_left ? "note" : "note end", distributions[i].name);
  }
  return drawing.svg();
}

std::string draw(const Course& course) {
  const Index n = std::ssize(course.values);
  const auto [lo, hi] = std::minmax_element(course.values.begin(), course.values.end());
  const auto steps = static_cast<int>(std::clamp<Index>(n - 1, 1, 5));  // ticks are whole
  Drawing drawing(axis(0, static_cast<double>(std::max<Index>(n - 1, 1)), course.counted, steps),
                  round_axis(*lo, *hi, course.label, 4), course.label + " by " + course.counted);
  drawing.add_grid();
  Points<2> points(2, n);
  for (Index i = 0; i < n; ++i) points.col(i) << static_cast<double>(i), course.values[i];
  drawing.add_line(points, "curve");
  constexpr Index few = 40;  // dots, ten pixels apart
  if (n <= few) drawing.add_dots(points, 3, "accent");
  return drawing.svg();
}

void extend(const Eigen::VectorXd& values, double& lo, double& hi) {
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    lo = std::min(lo, value);
    hi = std::max(hi, value);
  }
}

LinearRgb ColorScale::operator()(double value) const {
  const double t = hi > lo ? (value - lo) / (hi - lo) : 0.5;
  return diverging ? diverging_color(2 * t - 1) : sequential_color(t);
}

std::vector<std::string> color_stops(bool diverging) {
  constexpr int count = 17;  // the viewer interpolates linearly: fewer stops would show
  const ColorScale scale{.diverging = diverging};
  std::vector<std::string> stops;
  for (int i = 0; i < count; ++i) stops.push_back(hex_color(scale(static_cast<double>(i) / (count - 1))));
  return stops;
}

std::string draw(const PlaneMap& map) {
  constexpr double narrow = 300;  // pixels; fewer ticks on axes below that
  const Point<2> extent = map.box.extent();
  double width = map.width;
  double height = map.to_scale ? width * extent.y() / extent.x() : 0.75 * width;
  const double tallest = 1.1 * width;  // taller maps are made narrower
  if (height > tallest) {
    width *= tallest / height;
    height = tallest;
  }
  const Axis x = axis(map.box.lo.x(), map.box.hi.x(), map.x_label, width > narrow ? 5 : 3);
  Drawing drawing(x, axis(map.box.lo.y(), map.box.hi.y(), map.y_label, height > narrow / 2 ? 5 : 2), map.description,
                  width, height);
  const bool has_colors = map.dot_values.size() > 0;
  if (!has_colors)
    drawing.add("<image href=\"" + picture_address(map.values, map.scale) + "\" x=\"" + coordinate(Drawing::left) +
                "\" y=\"" + coordinate(Drawing::top) + "\" width=\"" + coordinate(width) + "\" height=\"" +
                coordinate(height) + "\" preserveAspectRatio=\"none\"/>");
  drawing.add_segments(map.segments, "contour");
  constexpr Index many = 1500;  // dots, from which they are smaller
  if (has_colors)
    add_colored_dots(map, drawing);
  else
    drawing.add_dots(map.dots, map.dots.cols() > many ? 0.7 : 1.4, "samples");
  drawing.add_values("map", map_values(map));
  drawing.add_frame();
  drawing.add_color_bar(axis(map.scale.lo, map.scale.hi, map.scale.label, width > narrow ? 5 : 3),
                        bar_address(map.scale));
  return drawing.svg();
}

std::string side_by_side(const std::vector<std::string>& drawings) {
  std::string text = "<div class=\"trio\">\n";
  for (const std::string& drawing : drawings) text += drawing + "\n";
  return text + "</div>";
}

std::string draw(const Curve& curve) {
  double lo = std::numeric_limits<double>::infinity(), hi = -lo;
  extend(curve.line.row(1), lo, hi);
  extend(curve.dots.row(1), lo, hi);
  Drawing drawing(axis(curve.line.row(0).minCoeff(), curve.line.row(0).maxCoeff(), curve.x_label),
                  round_axis(lo, hi, curve.y_label), curve.y_label + " by " + curve.x_label);
  drawing.add_grid();
  drawing.add_dots(curve.dots, 1.8, "faint");
  drawing.add_line(curve.line, "curve");
  return drawing.svg();
}

}  // namespace csrbf::app
