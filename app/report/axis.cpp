#include "report/axis.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

namespace csrbf::app {
namespace {

constexpr double rounding = 1e-9;  // tolerance, of a step: above that of doubles, below what can be seen

// 1, 2 or 5 times a power of ten, such that about `count` of them fill the range.
double round_step(double range, int count) {
  const double raw = range / count;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  const double mantissa = raw / power;
  return power * (mantissa < 1.5 ? 1 : mantissa < 3.5 ? 2 : mantissa < 7.5 ? 5 : 10);
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
  return pretty_number(text.data());
}

std::string readable(double value, int digits) {
  std::array<char, 40> text{};
  constexpr double plain_below = 1e9;  // powers of ten from here on
  const double size = std::abs(value), most = std::pow(10.0, digits);
  if (!(size >= most && size < plain_below)) {
    std::snprintf(text.data(), text.size(), "%.*g", digits, value);
    return pretty_number(text.data());
  }
  const double unit = std::pow(10.0, std::floor(std::log10(size)) + 1 - digits);
  std::snprintf(text.data(), text.size(), "%.0f", unit * std::round(size / unit));
  std::string whole = text.data();
  constexpr std::size_t group = 3;
  for (std::size_t at = whole.size(); at > group; at -= group) whole.insert(at - group, 1, ',');
  return (value < 0 ? "−" : "") + whole;
}

std::string pretty_number(const std::string& text) {
  constexpr std::array<const char*, 10> raised{"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  const std::size_t e = text.find('e');
  std::string result;
  for (const char c : text.substr(0, e)) result += c == '-' ? "−" : std::string(1, c);
  if (e == std::string::npos) return result;
  const int power = std::stoi(text.substr(e + 1));
  result += "×10";
  if (power < 0) result += "⁻";
  for (const char c : std::to_string(std::abs(power))) result += raised[c - '0'];
  return result;
}

}  // namespace csrbf::app
