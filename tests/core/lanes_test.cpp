#include "csrbf/core/lanes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

namespace csrbf::lanes_test {
namespace {

constexpr int n = 8;
using Numbers = std::array<double, n>;
constexpr Numbers p = {1, -2, 3, 0, 5, 6.25, -7, 8};
constexpr Numbers q = {4, 2, -1, 0, 0.5, 1, 7, 9};

// Quotients, products, roots and comparisons, and the number of bytes that were asked for.
struct Mixture {
  template <int Bytes>
  CSRBF_ALWAYS_INLINE static int run(const double* a, const double* b, double* to) {
    using V = Lanes<double, n, Bytes>;
    const V x(a), y(b), sum = 2.0 * x - y / 4.0;
    const V root = sqrt(choose(x > 0.0, x, V(0.0)));
    choose((x < y) & (y != 0.5), sum + root, -sum).store(to);
    return Bytes;
  }
};

Numbers expected() {
  Numbers result{};
  for (std::size_t i = 0; i < n; ++i) {
    const double sum = 2 * p[i] - q[i] / 4, root = std::sqrt(p[i] > 0 ? p[i] : 0);
    result[i] = p[i] < q[i] && q[i] != 0.5 ? sum + root : -sum;
  }
  return result;
}

TEST(Lanes, HaveTheArithmeticOfPlainNumbersInVectorsOfAnyLength) {
  Numbers result{};
  Mixture::run<16>(p.data(), q.data(), result.data());
  EXPECT_EQ(result, expected());
  Mixture::run<32>(p.data(), q.data(), result.data());
  EXPECT_EQ(result, expected());
  Mixture::run<64>(p.data(), q.data(), result.data());
  EXPECT_EQ(result, expected());
}

TEST(Lanes, AreInRegistersOfTheProcessor) {
  Numbers result{};
  EXPECT_EQ(simd_call<Mixture>(p.data(), q.data(), result.data()), simd_bytes());
  EXPECT_EQ(result, expected());
  EXPECT_EQ((simd_call<Mixture, 32>(p.data(), q.data(), result.data())), std::min(simd_bytes(), 32));
  EXPECT_EQ(result, expected());
}

CSRBF_ALWAYS_INLINE double multiply_each(double factor, const Numbers& from, Numbers& to) {
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) sum += to[i] = factor * from[i];
  return sum;
}

TEST(Simd, CompilesFunctionsForAnyProcessor) {
  Numbers plain{}, best{};
  const double sum = multiply_each(3, p, plain);
  EXPECT_EQ(simd<multiply_each>(3, p, best), sum);
  EXPECT_EQ(best, plain);
}

TEST(Lanes, TellWhereAConditionHolds) {
  EXPECT_EQ(bits(Doubles(p.data()) < Doubles(q.data())), 0b11000011U);
  EXPECT_EQ(bits(Doubles(p.data()) > 100.0), 0U);
}

}  // namespace
}  // namespace csrbf::lanes_test
