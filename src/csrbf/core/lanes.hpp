#pragma once

#include "csrbf/core/simd.hpp"

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace csrbf {

/// Eight doubles with arithmetic lane by lane, for functions marked CSRBF_SIMD_CLONES: compilers do not reliably turn
/// loops over lanes that are inside other loops into vector code. Operators work in place, because vectors passed by
/// value need a calling convention of their own.
class Lanes {
 public:
  static constexpr int size = 8;

  CSRBF_ALWAYS_INLINE Lanes() = default;  // no value
  CSRBF_ALWAYS_INLINE explicit Lanes(double value) : low_(Half{} + value), high_(low_) {}
  CSRBF_ALWAYS_INLINE explicit Lanes(const double* from) {
    std::memcpy(&low_, from, sizeof low_);
    std::memcpy(&high_, from + size / 2, sizeof high_);
  }
  CSRBF_ALWAYS_INLINE void store(double* to) const {
    std::memcpy(to, &low_, sizeof low_);
    std::memcpy(to + size / 2, &high_, sizeof high_);
  }

  CSRBF_ALWAYS_INLINE Lanes& operator+=(const Lanes& b) {
    low_ += b.low_;
    high_ += b.high_;
    return *this;
  }
  CSRBF_ALWAYS_INLINE Lanes& operator-=(const Lanes& b) {
    low_ -= b.low_;
    high_ -= b.high_;
    return *this;
  }
  CSRBF_ALWAYS_INLINE Lanes& operator*=(const Lanes& b) {
    low_ *= b.low_;
    high_ *= b.high_;
    return *this;
  }
  CSRBF_ALWAYS_INLINE Lanes& operator+=(double b) {
    low_ += b;
    high_ += b;
    return *this;
  }
  CSRBF_ALWAYS_INLINE Lanes& operator-=(double b) { return *this += -b; }
  CSRBF_ALWAYS_INLINE Lanes& operator*=(double b) {
    low_ *= b;
    high_ *= b;
    return *this;
  }
  /// Negative numbers and NaN become 0.
  CSRBF_ALWAYS_INLINE void keep_positive() {
    low_ = low_ > 0 ? low_ : Half{};
    high_ = high_ > 0 ? high_ : Half{};
  }
  /// *this += a b
  CSRBF_ALWAYS_INLINE void add_product(const Lanes& a, const Lanes& b) {
    low_ += a.low_ * b.low_;
    high_ += a.high_ * b.high_;
  }
  CSRBF_ALWAYS_INLINE void add_product(double a, const Lanes& b) {
    low_ += a * b.low_;
    high_ += a * b.high_;
  }
  /// *this -= a b
  CSRBF_ALWAYS_INLINE void subtract_product(const Lanes& a, const Lanes& b) {
    low_ -= a.low_ * b.low_;
    high_ -= a.high_ * b.high_;
  }

 private:
  friend class LaneMask;
  using Half = double __attribute__((vector_size(size / 2 * sizeof(double))));
  Half low_, high_;
};

/// A condition of each of eight lanes; at first all hold.
class LaneMask {
 public:
  /// And |x| < bound; not for NaN.
  CSRBF_ALWAYS_INLINE void and_below(const Lanes& x, double bound) {
    low_ &= (x.low_ < bound) & (x.low_ > -bound);
    high_ &= (x.high_ < bound) & (x.high_ > -bound);
  }
  /// Bit l says whether the condition of lane l holds.
  [[nodiscard]] CSRBF_ALWAYS_INLINE unsigned bits() const {
    const Half all = low_ | high_;
    std::int64_t bit[Lanes::size / 2];
    std::memcpy(bit, &all, sizeof bit);
    return static_cast<unsigned>((bit[0] | bit[2]) | (bit[1] | bit[3]));
  }

 private:
  using Half = std::int64_t __attribute__((vector_size(Lanes::size / 2 * sizeof(std::int64_t))));
  Half low_ = {1, 2, 4, 8}, high_ = {16, 32, 64, 128};
};

/// Stores scale |p - q|^2 for points of `dim` coordinates, eight lanes each.
CSRBF_ALWAYS_INLINE void store_squared_distance(const double* p, const double* q, std::ptrdiff_t dim, double scale,
                                                double* to) {
  Lanes sum(0.0);
  for (std::ptrdiff_t a = 0; a < Lanes::size * dim; a += Lanes::size) {
    Lanes d(p + a);
    d -= Lanes(q + a);
    sum.add_product(d, d);
  }
  sum *= scale;
  sum.store(to);
}

}  // namespace csrbf
