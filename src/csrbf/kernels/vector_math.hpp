#pragma once

#include "csrbf/core/numbers/bit_cast.hpp"
#include "csrbf/core/simd.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

/// Elementary functions without branches or calls, so that the loops they are inlined into can be vectorised.
namespace csrbf {

/// a^Exponent.
template <int Exponent>
CSRBF_ALWAYS_INLINE double integer_power(double a) {
  static_assert(Exponent >= 0);
  if constexpr (Exponent == 0) {
    return 1;
  } else if constexpr (Exponent % 2 == 0) {
    return integer_power<Exponent / 2>(a * a);
  } else {
    return a * integer_power<Exponent - 1>(a);
  }
}

/// The polynomial of the given degree < Size with these coefficients, that of x^0 first. Recursive, as compilers do
/// not unroll an inner loop early enough to vectorise the outer one.
template <int Degree, int First = 0, std::size_t Size>
CSRBF_ALWAYS_INLINE double polynomial_value(const std::array<double, Size>& coefficients, double x) {
  static_assert(Degree < static_cast<int>(Size));
  if constexpr (First == Degree) {
    return coefficients[First];
  } else {
    return coefficients[First] + x * polynomial_value<Degree, First + 1>(coefficients, x);
  }
}

inline constexpr double log2_high = 6.93147180369123816490e-01;  // log 2 = high + low; high has 21 trailing zero bits
inline constexpr double log2_low = 1.90821492927058770002e-10;

/// exp(x) within two roundings; 0 below -708, exp(709) above 709.
CSRBF_ALWAYS_INLINE double vector_exp(double x) {
  constexpr double round = 0x1.8p52;  // adding it leaves the nearest integer in the low bits
  constexpr std::array<double, 14> series = {
      1.0,        1.0,         1.0 / 2,      1.0 / 6,       1.0 / 24,       1.0 / 120,       1.0 / 720,
      1.0 / 5040, 1.0 / 40320, 1.0 / 362880, 1.0 / 3628800, 1.0 / 39916800, 1.0 / 479001600, 1.0 / 6227020800};
  double y = x < -708 ? -708 : x;
  y = y > 709 ? 709 : y;
  constexpr double log2_e = 1.4426950408889634;
  const double shifted = y * log2_e + round;
  const double k = shifted - round;
  const double f = (y - k * log2_high) - k * log2_low;
  const double power_of_two = bit_cast<double>((bit_cast<std::uint64_t>(shifted) + 1023) << 52);
  const double result = polynomial_value<13>(series, f) * power_of_two;
  return x < -708 ? 0 : result;
}

/// log(x) within two roundings for normal x > 0; NaN for NaN; undefined for all other x.
CSRBF_ALWAYS_INLINE double vector_log(double x) {
  // x = 2^k m with m in [.69, 1.38); log m = 2 artanh(s).
  constexpr std::array<double, 11> series = {2.0,      2.0 / 3,  2.0 / 5,  2.0 / 7,  2.0 / 9, 2.0 / 11,
                                             2.0 / 13, 2.0 / 15, 2.0 / 17, 2.0 / 19, 2.0 / 21};
  constexpr std::uint64_t offset = 0x3fe6000000000000;  // bits of .6875, the lower end of m
  constexpr std::uint64_t one = 0x3ff0000000000000;     // bits of 1
  const auto bits = bit_cast<std::uint64_t>(x);
  const std::uint64_t exponent = (bits - offset + one) >> 52;  // k + 1023
  const double k = bit_cast<double>(exponent | 0x4330000000000000) - (0x1p52 + 1023);
  const double m = bit_cast<double>(bits - (exponent << 52) + one);
  const double s = (m - 1) / (m + 1);
  const double result = k * log2_high + (s * polynomial_value<10>(series, s * s) + k * log2_low);
  return x != x ? x : result;
}

}  // namespace csrbf
