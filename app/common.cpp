#include "common.hpp"

#include "csrbf/io/files/text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace csrbf::app {

std::string rounded(double value, int digits) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.*g", digits, value);
  return text.data();
}

std::string rounded_within(double extent, double value) {
  constexpr double usual = 4, most = 15;
  const double more = extent > 0 ? std::max(0.0, std::ceil(std::log10(std::abs(value) / extent))) : 0;
  return rounded(value, static_cast<int>(std::min(usual + more, most)));
}

std::string grouped(Index count) {
  return grouped(std::to_string(count));
}

std::string grouped(std::string number) {
  constexpr std::size_t group = 3;
  const std::size_t first = number.find_first_not_of('-'), point = std::min(number.find('.'), number.size());
  for (std::size_t at = point; at > first + group;) number.insert(at -= group, 1, ',');
  return number;
}

std::string counted(Index count, const std::string& noun) {
  const std::string digits = grouped(count);
  if (count == 1) return digits + " " + noun;
  if (noun.ends_with("x")) return digits + " " + noun.substr(0, noun.size() - 2) + "ices";
  return digits + " " + noun + (noun.ends_with("ch") ? "es" : "s");
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
  return (value < 0 ? "−" : "") + grouped(text.data());
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

Eigen::VectorXd parse_numbers(const std::string& text, char separator, Index count, const std::string& flag) {
  Eigen::VectorXd numbers(count);
  std::string_view rest = text;
  for (Index i = 0; i < count; ++i) {
    const std::size_t end = i + 1 < count ? rest.find(separator) : rest.size();
    const auto number = end == std::string_view::npos ? std::nullopt : parse_number(trimmed(rest.substr(0, end)));
    if (!number || !std::isfinite(*number))
      throw UsageError(flag + " " + text + ": expected " + std::to_string(count) +
                       (count == 1 ? " number" : std::string(" numbers separated by \"") + separator + '"'));
    numbers[i] = *number;
    rest.remove_prefix(std::min(rest.size(), end + 1));
  }
  return numbers;
}

Eigen::VectorXd parse_list(const std::string& text, char separator, const std::string& flag) {
  return parse_numbers(text, separator, 1 + std::count(text.begin(), text.end(), separator), flag);
}

std::optional<double> parse_smoothing(const std::string& text) {
  if (text == "none") return 0;
  return parse_word_or_number(text, "auto", "--smoothing");
}

std::optional<double> parse_word_or_number(const std::string& text, const std::string& word, const std::string& flag) {
  if (text == word) return std::nullopt;
  const std::optional<double> number = parse_number(text);
  if (!number) throw UsageError(flag + " " + text + ": expected \"" + word + "\" or a number");
  return number;
}

}  // namespace csrbf::app
