#pragma once

#include "csrbf/core/simd.hpp"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace csrbf {

/// `count` numbers with arithmetic lane by lane, in vectors of the compiler of at most `bytes` each: compilers do not
/// reliably turn loops over lanes that are inside other loops into vector code, and never sums. The arithmetic is that
/// of plain numbers, of each lane by itself: results do not depend on `bytes`. Vectors longer than the registers would
/// go through memory (GCC): in functions marked CSRBF_SIMD_CLONES `bytes` is 32, in those that simd_call() calls it is
/// the parameter of theirs.
///
/// Arguments are references, because vectors passed by value need a calling convention of their own.
template <class T, int count, int bytes = 32>
struct Lanes {
  static constexpr int size = count;
  static constexpr int width = count * sizeof(T) <= bytes ? count : static_cast<int>(bytes / sizeof(T));
  static constexpr int parts = count / width;
  static_assert(parts * width == count);

  using Part [[gnu::vector_size(width * sizeof(T))]] = T;
  /// What comparisons give: integers, -1 where the condition holds and 0 elsewhere.
  using Mask = Lanes<std::conditional_t<sizeof(T) == 8, std::int64_t, std::int32_t>, count, bytes>;

  Part part[parts];

  CSRBF_ALWAYS_INLINE Lanes() = default;  // no value
  CSRBF_ALWAYS_INLINE explicit Lanes(T value) {
    for (int k = 0; k < parts; ++k) part[k] = Part{} + value;
  }
  CSRBF_ALWAYS_INLINE explicit Lanes(const T* from) {
    for (int k = 0; k < parts; ++k) std::memcpy(&part[k], from + k * width, sizeof(Part));
  }
  CSRBF_ALWAYS_INLINE void store(T* to) const {
    for (int k = 0; k < parts; ++k) std::memcpy(to + k * width, &part[k], sizeof(Part));
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
  friend CSRBF_ALWAYS_INLINE Lanes operator-(const Lanes& a) {
    Lanes c;
    for (int k = 0; k < parts; ++k) c.part[k] = -a.part[k];
    return c;
  }
  CSRBF_LANE_ASSIGNMENT(+)
  CSRBF_LANE_ASSIGNMENT(-)
  CSRBF_LANE_ASSIGNMENT(*)
  CSRBF_LANE_ASSIGNMENT(/)
  CSRBF_LANE_ASSIGNMENT(&)  // of masks, as the next
  CSRBF_LANE_ASSIGNMENT(|)
  CSRBF_LANE_OPERATOR(Mask, <)
  CSRBF_LANE_OPERATOR(Mask, >)
  CSRBF_LANE_OPERATOR(Mask, !=)
#undef CSRBF_LANE_ASSIGNMENT
#undef CSRBF_LANE_OPERATOR

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
  const Doubles::Mask::Part all = set.part[0] | set.part[1];
  return static_cast<unsigned>((all[0] | all[2]) | (all[1] | all[3]));
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
