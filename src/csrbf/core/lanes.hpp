#pragma once

#include "csrbf/core/simd.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace csrbf {

/// `Count` numbers with arithmetic lane by lane, in vectors of the compiler of at most `Bytes` each, for loops that
/// compilers do not turn into vector code: those inside other loops, and sums, whose order they keep. Each lane has the
/// arithmetic of plain numbers, so results do not depend on `Bytes`. GCC keeps vectors that are longer than the
/// registers in memory: use the parameter of the kernel in those that simd_call() calls, else the default.
///
/// A product that is added is rounded once where the processor can. Give names to two products before adding them:
/// which of them that is depends on which one the compiler computes first.
///
/// Arguments are references, because vectors passed by value need a calling convention of their own.
template <class T, int Count, int Bytes = simd_vector_bytes>
struct Lanes {
  static constexpr int size = Count;
  static constexpr int width = Count * sizeof(T) <= Bytes ? Count : static_cast<int>(Bytes / sizeof(T));
  static constexpr int parts = Count / width;
  static_assert(parts * width == Count);

  using Part [[gnu::vector_size(width * sizeof(T))]] = T;
  using Unaligned [[gnu::vector_size(width * sizeof(T)), gnu::aligned(alignof(T))]] = T;
  /// What comparisons give: integers, -1 where the condition holds and 0 elsewhere.
  using Mask = Lanes<std::conditional_t<sizeof(T) == 8, std::int64_t, std::int32_t>, Count, Bytes>;

  Part part[parts];

  CSRBF_ALWAYS_INLINE Lanes() = default;  // no value
  CSRBF_ALWAYS_INLINE explicit Lanes(T value) {
    for (int k = 0; k < parts; ++k) part[k] = Part{} + value;
  }
  CSRBF_ALWAYS_INLINE explicit Lanes(const T* from) {
    for (int k = 0; k < parts; ++k) part[k] = *reinterpret_cast<const Unaligned*>(from + k * width);
  }
  CSRBF_ALWAYS_INLINE void store(T* to) const {
    for (int k = 0; k < parts; ++k) *reinterpret_cast<Unaligned*>(to + k * width) = part[k];
  }
  CSRBF_ALWAYS_INLINE T operator[](int lane) const { return part[lane / width][lane % width]; }

#define CSRBF_LANE_OPERATOR(Result, op)                                           \
  friend CSRBF_ALWAYS_INLINE Result operator op(const Lanes& a, const Lanes& b) { \
    Result c;                                                                     \
    for (int k = 0; k < parts; ++k) c.part[k] = a.part[k] op b.part[k];           \
    return c;                                                                     \
  }                                                                               \
  friend CSRBF_ALWAYS_INLINE Result operator op(const Lanes& a, T b) {            \
    Result c;                                                                     \
    for (int k = 0; k < parts; ++k) c.part[k] = a.part[k] op b;                   \
    return c;                                                                     \
  }                                                                               \
  friend CSRBF_ALWAYS_INLINE Result operator op(T a, const Lanes& b) {            \
    Result c;                                                                     \
    for (int k = 0; k < parts; ++k) c.part[k] = a op b.part[k];                   \
    return c;                                                                     \
  }
#define CSRBF_LANE_ASSIGNMENT(op)                         \
  CSRBF_LANE_OPERATOR(Lanes, op)                          \
  template <class B>                                      \
  CSRBF_ALWAYS_INLINE Lanes& operator op##=(const B& b) { \
    return *this = *this op b;                            \
  }
  CSRBF_LANE_ASSIGNMENT(+)
  CSRBF_LANE_ASSIGNMENT(-)
  CSRBF_LANE_ASSIGNMENT(*)
  CSRBF_LANE_ASSIGNMENT(/)
  CSRBF_LANE_ASSIGNMENT(&)  // of masks
  CSRBF_LANE_OPERATOR(Mask, <)
  CSRBF_LANE_OPERATOR(Mask, >)
  CSRBF_LANE_OPERATOR(Mask, !=)
#undef CSRBF_LANE_ASSIGNMENT
#undef CSRBF_LANE_OPERATOR

  friend CSRBF_ALWAYS_INLINE Lanes operator-(const Lanes& a) {
    Lanes c;
    for (int k = 0; k < parts; ++k) c.part[k] = -a.part[k];
    return c;
  }
  /// Lanes of a where the condition holds, of b elsewhere.
  friend CSRBF_ALWAYS_INLINE Lanes choose(const Mask& condition, const Lanes& a, const Lanes& b) {
    Lanes c;
    for (int k = 0; k < parts; ++k) c.part[k] = condition.part[k] ? a.part[k] : b.part[k];
    return c;
  }
  friend CSRBF_ALWAYS_INLINE Lanes sqrt(const Lanes& a) {
    Lanes c;
    for (int k = 0; k < parts; ++k)
      for (int i = 0; i < width; ++i) c.part[k][i] = std::sqrt(a.part[k][i]);
    return c;
  }
};

/// Eight doubles, of as many systems, cells or points.
using Doubles = Lanes<double, 8>;

/// Bit l says whether the condition holds in lane l.
CSRBF_ALWAYS_INLINE unsigned bits(const Doubles::Mask& condition) {
  static constexpr std::int64_t powers[] = {1, 2, 4, 8, 16, 32, 64, 128};
  const Doubles::Mask set = condition & Doubles::Mask(powers);
  Doubles::Mask::Part all = set.part[0];
  for (int k = 1; k < Doubles::parts; ++k) all |= set.part[k];
  std::int64_t result = 0;
  for (int i = 0; i < Doubles::width; ++i) result |= all[i];
  return static_cast<unsigned>(result);
}

/// Stores scale |p - q|^2 for points of `dim` coordinates, eight lanes each.
CSRBF_ALWAYS_INLINE void store_squared_distance(const double* p, const double* q, std::ptrdiff_t dim, double scale,
                                                double* to) {
  Doubles sum(0.0);
  for (std::ptrdiff_t a = 0; a < Doubles::size * dim; a += Doubles::size) {
    const Doubles d = Doubles(p + a) - Doubles(q + a);
    sum += d * d;
  }
  (sum * scale).store(to);
}

}  // namespace csrbf
