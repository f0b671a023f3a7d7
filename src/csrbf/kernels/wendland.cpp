#include "csrbf/kernels/wendland.hpp"

#include <array>

namespace csrbf {
namespace {

// The polynomial factor of phi_{d,k} for l = floor(d/2) + k + 1, normalised to 1 at r = 0.
std::array<double, 4> polynomial(double l, int k) {
  switch (k) {
    case 0:
      return {1, 0, 0, 0};
    case 1:
      return {1, l + 1, 0, 0};
    case 2:
      return {1, l + 2, (l + 1) * (l + 3) / 3, 0};
    default:
      return {1, l + 3, (2 * l * l + 12 * l + 15) / 5, (l + 1) * (l + 3) * (l + 5) / 15};
  }
}

// phi'/r at r = 0, so that phi_{d,k}'/r = g0 phi_{d+2,k-1}: the dimension walk, which preserves l.
double g0(double l, int k) {
  switch (k) {
    case 1:
      return -(l + 1) * (l + 2);
    case 2:
      return -(l + 3) * (l + 4) / 3;
    default:
      return -(l + 5) * (l + 6) / 5;
  }
}

template <int Exponent>
CSRBF_ALWAYS_INLINE double power(double a) {
  static_assert(Exponent >= 0);
  if constexpr (Exponent == 0) {
    return 1;
  } else if constexpr (Exponent % 2 == 0) {
    return power<Exponent / 2>(a * a);
  } else {
    return a * power<Exponent - 1>(a);
  }
}

double power(double a, int exponent) {
  double result = 1;
  for (; exponent > 0; exponent /= 2, a *= a)
    if (exponent % 2 == 1) result *= a;
  return result;
}

template <int Degree, std::size_t Size>
CSRBF_ALWAYS_INLINE double horner(const std::array<double, Size>& coefficients, double r) {
  double sum = coefficients[Degree];
  for (int j = Degree - 1; j >= 0; --j) sum = sum * r + coefficients[j];
  return sum;
}

// phi = (1-r)^(l+k) sum_j value[j] r^j, degree k; g = (1-r)^(l+k-1) sum_j g[j] r^j, degree k - 1; and
// h = (1-r)^(l+k-2) sum_j h[j] r^j, degree k - 2, over r for k = 1.
struct Coefficients {
  std::array<double, 4> value;
  std::array<double, 3> g;
  std::array<double, 2> h;
};

template <int L, int K, RadialParts parts>
CSRBF_ALWAYS_INLINE void evaluate_blocks(const Coefficients c, const double* __restrict r2, Index n,
                                         double* __restrict phi, double* __restrict g, double* __restrict h) {
  const Index end = n & -radial_block;
  for (Index i = 0; i < end; ++i) {
    double r = std::sqrt(r2[i]);
    r = 1 < r ? 1 : r;  // keeps NaN
    const double a = 1 - r;
    if constexpr (parts == RadialParts::value) {
      phi[i] = power<L + K>(a) * horner<K>(c.value, r);
    } else {
      const double common = power<L + K - 2>(a);
      phi[i] = common * a * a * horner<K>(c.value, r);
      g[i] = common * a * horner<K - 1>(c.g, r);
      if constexpr (parts == RadialParts::hessian && K >= 2) h[i] = common * horner<K - 2>(c.h, r);
      if constexpr (parts == RadialParts::hessian && K == 1) h[i] = r > 0 ? common * c.h[0] / r : r;
    }
  }
}

// One loop per exponent l + K and polynomial degree K, for l of d <= 7. (With the last case as the default, and with
// the functions of vector_math.hpp, GCC 12 vectorises less of them.)
template <int K, RadialParts parts>
CSRBF_ALWAYS_INLINE void evaluate_smooth(int l, const Coefficients& c, const double* r2, Index n,
                                         const RadialOutput& out) {
  switch (l - K) {
    case 1:
      return evaluate_blocks<K + 1, K, parts>(c, r2, n, out.phi, out.g, out.h);
    case 2:
      return evaluate_blocks<K + 2, K, parts>(c, r2, n, out.phi, out.g, out.h);
    case 3:
      return evaluate_blocks<K + 3, K, parts>(c, r2, n, out.phi, out.g, out.h);
    case 4:
      return evaluate_blocks<K + 4, K, parts>(c, r2, n, out.phi, out.g, out.h);
    default:
      return;
  }
}

template <RadialParts parts>
CSRBF_ALWAYS_INLINE void evaluate_any(int l, int k, const Coefficients& c, const double* r2, Index n,
                                      const RadialOutput& out) {
  switch (k) {
    case 1:
      return evaluate_smooth<1, parts>(l, c, r2, n, out);
    case 2:
      return evaluate_smooth<2, parts>(l, c, r2, n, out);
    case 3:
      return evaluate_smooth<3, parts>(l, c, r2, n, out);
    default:
      if constexpr (parts == RadialParts::value) return evaluate_smooth<0, parts>(l, c, r2, n, out);
      return;
  }
}

class Wendland : public RadialFunction {
 public:
  Wendland(int dimension, int smoothness) : l_(dimension / 2 + smoothness + 1), k_(smoothness) {
    const double l = l_;
    c_.value = polynomial(l, k_);
    if (k_ >= 1) {
      const double scale = g0(l, k_);
      const auto walked = polynomial(l, k_ - 1);
      for (std::size_t j = 0; j < c_.g.size(); ++j) c_.g[j] = scale * walked[j];
    }
    if (k_ == 1) c_.h[0] = -l * c_.g[0];  // g' / r = g0 ((1-r)^l)' / r
    if (k_ >= 2) {
      const double scale = c_.g[0] * g0(l, k_ - 1);
      const auto walked = polynomial(l, k_ - 2);
      for (std::size_t j = 0; j < c_.h.size(); ++j) c_.h[j] = scale * walked[j];
    }
  }

  void evaluate(const double* r2, Index n, const RadialOutput& out) const override {
    if (l_ - k_ > 4 || (k_ == 0 && out.g != nullptr)) return evaluate_each(r2, n, out);
    using enum RadialParts;
    const auto loop = out.g == nullptr   ? simd<evaluate_any<value>>
                      : out.h == nullptr ? simd<evaluate_any<gradient>>
                                         : simd<evaluate_any<hessian>>;
    in_radial_blocks([&](const double* s, Index count, const RadialOutput& part) { loop(l_, k_, c_, s, count, part); },
                     r2, n, out);
  }

 private:
  // Where there is no loop.
  void evaluate_each(const double* r2, Index n, const RadialOutput& out) const {
    for (Index i = 0; i < n; ++i) {
      const double r = std::sqrt(r2[i]);
      out.phi[i] = value(r);
      if (out.g != nullptr) out.g[i] = g(r);
      if (out.h != nullptr) out.h[i] = h(r);
    }
  }

  [[nodiscard]] double value(double r) const { return r >= 1 ? 0 : power(1 - r, l_ + k_) * horner<3>(c_.value, r); }

  [[nodiscard]] double g(double r) const {
    if (r >= 1) return 0;
    if (k_ == 0) return r == 0 ? 0 : -l_ * power(1 - r, l_ - 1) / r;
    return power(1 - r, l_ + k_ - 1) * horner<2>(c_.g, r);
  }

  [[nodiscard]] double h(double r) const {
    if (r >= 1 || (r == 0 && k_ <= 1)) return 0;
    if (k_ == 0) return ((l_ == 1 ? 0 * r : l_ * (l_ - 1) * power(1 - r, l_ - 2)) - g(r)) / (r * r);
    if (k_ == 1) return c_.h[0] * r * power(1 - r, l_ - 1) / (r * r);
    return power(1 - r, l_ + k_ - 2) * horner<1>(c_.h, r);
  }

  int l_;  // floor(d/2) + k + 1
  int k_;
  Coefficients c_{};
};

}  // namespace

std::shared_ptr<const RadialFunction> wendland_function(int dimension, int smoothness) {
  return std::make_shared<Wendland>(dimension, smoothness);
}

}  // namespace csrbf
