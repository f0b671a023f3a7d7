#include "curve.hpp"

#include "csrbf/io/files/atomic_file.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

void write_svg(const std::string& path, const std::string& title, const std::vector<Curve>& curves) {
  constexpr double width = 640, height = 360, left = 60, right = 20, top = 40, bottom = 40;
  double largest = 0;
  std::size_t frames = 2;
  for (const Curve& curve : curves) {
    for (const double value : curve.values) largest = std::max(largest, value);
    frames = std::max(frames, curve.values.size());
  }
  const double step = 0.5 * std::pow(10, std::floor(std::log10(std::max(largest, 1e-300))));
  const double ceiling = step * std::ceil(largest / step);
  const auto x = [&](std::size_t t) {
    return left + (width - left - right) * static_cast<double>(t) / static_cast<double>(frames - 1);
  };
  const auto y = [&](double value) { return height - bottom - (height - top - bottom) * value / ceiling; };
  std::ostringstream svg;
  svg << R"(<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 )" << width << ' ' << height
      << R"(" font-family="sans-serif" font-size="12">)"
      << R"(<rect width="100%" height="100%" fill="white"/><text x=")" << left << R"(" y="22" font-size="14">)" << title
      << "</text>\n";
  for (int k = 0; k <= 4; ++k) {
    const double value = ceiling * k / 4;
    svg << R"(<path stroke="#ddd" d="M)" << left << ' ' << y(value) << 'H' << width - right << R"("/><text x=")"
        << left - 6 << R"(" y=")" << y(value) + 4 << R"(" text-anchor="end">)" << value << "</text>\n";
  }
  for (std::size_t t = 0; t < frames; t += std::max<std::size_t>(1, frames / 8))
    svg << R"(<text text-anchor="middle" x=")" << x(t) << R"(" y=")" << height - bottom + 18 << R"(">)" << t
        << "</text>\n";
  double legend = top + 12;
  for (const Curve& curve : curves) {
    svg << R"(<polyline fill="none" stroke-width="1.6" stroke=")" << curve.color << R"(" points=")";
    for (std::size_t t = 0; t < curve.values.size(); ++t) svg << x(t) << ',' << y(curve.values[t]) << ' ';
    svg << R"("/><text x=")" << left + 12 << R"(" y=")" << height - bottom - 70 + legend - top << R"(" fill=")"
        << curve.color << R"(">)" << curve.name << "</text>\n";
    legend += 16;
  }
  svg << "</svg>\n";
  csrbf::write_file(path, svg.str());
}

void write_csv(const std::string& path, const std::vector<Curve>& curves) {
  std::ostringstream csv;
  csv << "frame";
  std::size_t frames = 0;
  for (const Curve& curve : curves) {
    csv << ',' << curve.name;
    frames = std::max(frames, curve.values.size());
  }
  csv << '\n';
  csv.precision(9);
  for (std::size_t t = 0; t < frames; ++t) {
    csv << t;
    for (const Curve& curve : curves) csv << ',' << curve.values.at(t);
    csv << '\n';
  }
  csrbf::write_file(path, csv.str());
}
