#include "csrbf/core/numbers/number_text.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <string>

namespace csrbf {

// __cpp_lib_to_chars is defined where both directions know floating-point numbers.
#ifdef __cpp_lib_to_chars

std::from_chars_result read_number(const char* begin, const char* end, double& value) {
  const std::from_chars_result result = std::from_chars(begin, end, value);
  if (result.ec != std::errc::result_out_of_range) return result;
  // The wider type shows which of the two it is.
  long double wide = 0;
  const bool too_wide = std::from_chars(begin, end, wide).ec != std::errc();
  if (too_wide) return {begin, std::errc::invalid_argument};
  const double magnitude = std::abs(wide) > 1 ? std::numeric_limits<double>::infinity() : 0.0;
  value = wide < 0 ? -magnitude : magnitude;
  return result;
}

char* write_number(char* begin, char* end, double value) {
  return std::to_chars(begin, end, value).ptr;
}

char* write_number(char* begin, char* end, double value, int digits) {
  return std::to_chars(begin, end, value, std::chars_format::general, digits).ptr;
}

#else

namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

// A number in decimals as its text says it: mantissa * 10^exponent.
struct Decimal {
  const char* end = nullptr;  // behind the number; null: there is none
  std::uint64_t mantissa = 0;
  int exponent = 0;
  bool exact = true;  // the mantissa holds all digits
  bool negative = false;
};

void take_digits(Decimal& number, const char* end, bool behind_point, bool& any) {
  for (; number.end < end && is_digit(*number.end); ++number.end) {
    any = true;
    const bool fits = number.mantissa < (std::uint64_t{1} << 53) / 10 - 1;
    if (fits) {
      number.mantissa = 10 * number.mantissa + static_cast<std::uint64_t>(*number.end - '0');
      if (behind_point) --number.exponent;
    } else {
      number.exact = false;
    }
  }
}

Decimal parse_decimal(const char* begin, const char* end) {
  Decimal number;
  number.end = begin;
  if (begin < end && *begin == '-') {
    number.negative = true;
    ++number.end;
  }
  bool any = false;
  take_digits(number, end, false, any);
  if (number.end < end && *number.end == '.') {
    ++number.end;
    take_digits(number, end, true, any);
  }
  if (!any) return {};
  if (number.end < end && (*number.end == 'e' || *number.end == 'E')) {
    const char* at = number.end + 1;
    const bool down = at < end && *at == '-';
    if (at < end && (*at == '-' || *at == '+')) ++at;
    if (at < end && is_digit(*at)) {
      int exponent = 0;
      for (; at < end && is_digit(*at); ++at) exponent = std::min(100000, 10 * exponent + (*at - '0'));
      number.exponent += down ? -exponent : exponent;
      number.end = at;
    }
  }
  return number;
}

// The length of "inf", "infinity", "nan" or "nan(...)" in any case; 0: none of them.
std::size_t length_of_word(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (text.starts_with("infinity")) return 8;
  return text.starts_with("inf") || text.starts_with("nan") ? 3 : 0;
}

}  // namespace

std::from_chars_result read_number(const char* begin, const char* end, double& value) {
  const Decimal number = parse_decimal(begin, end);
  // A product or quotient of two numbers that are represented exactly is rounded once, which is right.
  constexpr int largest_exact_power = 22;
  if (number.end != nullptr && number.exact && std::abs(number.exponent) <= largest_exact_power) {
    constexpr double powers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    const auto m = static_cast<double>(number.mantissa);
    const double magnitude = number.exponent < 0 ? m / powers[-number.exponent] : m * powers[number.exponent];
    value = number.negative ? -magnitude : magnitude;
    return {number.end, std::errc()};
  }
  const char* stop = number.end;
  if (stop == nullptr) {
    const char* word = begin + (begin < end && *begin == '-' ? 1 : 0);
    const std::size_t length = length_of_word(std::string(word, std::min(end, word + 8)));
    if (length == 0) return {begin, std::errc::invalid_argument};
    stop = word + length;
  }
  value = std::strtod(std::string(begin, stop).c_str(), nullptr);
  const bool in_range = number.end == nullptr || (std::isfinite(value) && (value != 0 || number.mantissa == 0));
  return {stop, in_range ? std::errc() : std::errc::result_out_of_range};
}

char* write_number(char* begin, char* end, double value) {
  constexpr int always_enough = 17;
  for (int digits = 15;; ++digits) {
    char* const stop = write_number(begin, end, value, digits);
    double read = 0;
    read_number(begin, stop, read);
    if (digits == always_enough || read == value || std::isnan(value)) return stop;
  }
}

char* write_number(char* begin, char* end, double value, int digits) {
  return begin + std::snprintf(begin, static_cast<std::size_t>(end - begin), "%.*g", digits, value);
}

#endif

}  // namespace csrbf
