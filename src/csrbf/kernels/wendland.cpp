#include "csrbf/kernels/wendland.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/simd.hpp"

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

// The polynomials of one function, see Wendland.
struct Coefficients {
  std::array<double, 4> value;
  std::array<double, 3> g;
  std::array<double, 2> h;
};

enum class Parts { value, gradient, hessian };

struct Output {
  double* phi;
  double* g;
  double* h;
};

// One register of AVX-512, two of AVX2. Loops round n down to a multiple of it, which n is, so that the compiler emits
// vector code without a remainder loop.
constexpr Index block_size = 8;

template <int L, int K, Parts parts>
CSRBF_ALWAYS_INLINE void evaluate_blocks(const Coefficients c, const double* __restrict r2, Index n,
                                         double* __restrict phi, double* __restrict g, double* __restrict h) {
  const Index end = n & -block_size;
  for (Index i = 0; i < end; ++i) {
    double r = std::sqrt(r2[i]);
    r = 1 < r ? 1 : r;  // keeps NaN
    const double a = 1 - r;
    if constexpr (parts == Parts::value) {
      phi[i] = power<L + K>(a) * horner<K>(c.value, r);
    } else {
      const double common = power<L + K - 2>(a);
      phi[i] = common * a * a * horner<K>(c.value, r);
      g[i] = common * a * horner<K - 1>(c.g, r);
      if constexpr (parts == Parts::hessian && K >= 2) h[i] = common * horner<K - 2>(c.h, r);
      if constexpr (parts == Parts::hessian && K == 1) h[i] = r > 0 ? common * c.h[0] / r : r;
    }
  }
}

// One loop per exponent and polynomial degree. Returns false for l of d > 7, for which there is none.
template <int K, Parts parts>
CSRBF_ALWAYS_INLINE bool evaluate_smooth(int l, const Coefficients& c, const double* r2, Index n, const Output& out) {
  switch (l - K) {
    case 1:
      evaluate_blocks<K + 1, K, parts>(c, r2, n, out.phi, out.g, out.h);
      return true;
    case 2:
      evaluate_blocks<K + 2, K, parts>(c, r2, n, out.phi, out.g, out.h);
      return true;
    case 3:
      evaluate_blocks<K + 3, K, parts>(c, r2, n, out.phi, out.g, out.h);
      return true;
    case 4:
      evaluate_blocks<K + 4, K, parts>(c, r2, n, out.phi, out.g, out.h);
      return true;
    default:
      return false;
  }
}

template <Parts parts>
CSRBF_ALWAYS_INLINE bool evaluate_any(int l, int k, const Coefficients& c, const double* r2, Index n,
                                      const Output& out) {
  switch (k) {
    case 1:
      return evaluate_smooth<1, parts>(l, c, r2, n, out);
    case 2:
      return evaluate_smooth<2, parts>(l, c, r2, n, out);
    case 3:
      return evaluate_smooth<3, parts>(l, c, r2, n, out);
    default:
      if constexpr (parts == Parts::value) return evaluate_smooth<0, parts>(l, c, r2, n, out);
      return false;
  }
}

using Loop = bool (*)(int l, int k, const Coefficients& c, const double* r2, Index n, const Output& out);

CSRBF_SIMD_CLONES bool value_loop(int l, int k, const Coefficients& c, const double* r2, Index n, const Output& out) {
  return evaluate_any<Parts::value>(l, k, c, r2, n, out);
}
CSRBF_SIMD_CLONES bool gradient_loop(int l, int k, const Coefficients& c, const double* r2, Index n,
                                     const Output& out) {
  return evaluate_any<Parts::gradient>(l, k, c, r2, n, out);
}
CSRBF_SIMD_CLONES bool hessian_loop(int l, int k, const Coefficients& c, const double* r2, Index n, const Output& out) {
  return evaluate_any<Parts::hessian>(l, k, c, r2, n, out);
}

// Runs a loop that handles full blocks only, for any n.
bool run(Loop loop, int l, int k, const Coefficients& c, const double* r2, Index n, const Output& out) {
  const auto shifted = [](double* part, Index i) { return part == nullptr ? nullptr : part + i; };
  if (n >= block_size) {
    if (!loop(l, k, c, r2, n, out)) return false;
    if (n % block_size == 0) return true;
    const Index i = n - block_size;  // the last block overlaps the one before
    return loop(l, k, c, r2 + i, block_size, {out.phi + i, shifted(out.g, i), shifted(out.h, i)});
  }
  double few[block_size] = {};
  double parts[3][block_size];
  std::copy(r2, r2 + n, few);
  if (!loop(l, k, c, few, block_size, {parts[0], parts[1], parts[2]})) return false;
  std::copy(parts[0], parts[0] + n, out.phi);
  if (out.g != nullptr) std::copy(parts[1], parts[1] + n, out.g);
  if (out.h != nullptr) std::copy(parts[2], parts[2] + n, out.h);
  return true;
}

}  // namespace

Wendland::Wendland(int dimension, int smoothness) : dimension_(dimension), smoothness_(smoothness) {
  require(dimension >= 1, "Wendland", "dimension", dimension, "must be at least 1; give the dimension of the points");
  require(smoothness >= 0 && smoothness <= 3, "Wendland", "smoothness", smoothness,
          "must be 0, 1, 2 or 3; the function has twice as many continuous derivatives");
  l_ = dimension / 2 + smoothness + 1;
  const double l = l_;
  value_ = polynomial(l, smoothness);
  if (smoothness >= 1) {
    const double scale = g0(l, smoothness);
    const auto walked = polynomial(l, smoothness - 1);
    for (std::size_t j = 0; j < g_.size(); ++j) g_[j] = scale * walked[j];
  }
  if (smoothness == 1) h_[0] = -l * g_[0];  // g' / r = g0 ((1-r)^l)' / r
  if (smoothness >= 2) {
    const double scale = g_[0] * g0(l, smoothness - 1);
    const auto walked = polynomial(l, smoothness - 2);
    for (std::size_t j = 0; j < h_.size(); ++j) h_[j] = scale * walked[j];
  }
}

double Wendland::value(double r) const {
  if (r >= 1) return 0;
  return power(1 - r, l_ + smoothness_) * horner<3>(value_, r);
}

double Wendland::g(double r) const {
  if (r >= 1) return 0;
  const double a = 1 - r;
  if (smoothness_ == 0) return r == 0 ? 0 : -l_ * power(a, l_ - 1) / r;
  return power(a, l_ + smoothness_ - 1) * horner<2>(g_, r);
}

double Wendland::h(double r) const {
  if (r >= 1 || (r == 0 && smoothness_ <= 1)) return 0;
  if (smoothness_ <= 1) return q(r) / (r * r);
  return power(1 - r, l_ + smoothness_ - 2) * horner<1>(h_, r);
}

double Wendland::q(double r) const {
  if (r >= 1) return 0;
  if (smoothness_ == 0) return r == 0 ? 0 : second(r) - g(r);
  if (smoothness_ == 1) return h_[0] * r * power(1 - r, l_ - 1);
  return r * r * h(r);
}

double Wendland::second(double r) const {
  if (r >= 1) return 0;
  if (smoothness_ == 0) return l_ == 1 ? 0 * r : l_ * (l_ - 1) * power(1 - r, l_ - 2);
  return g(r) + q(r);
}

double Wendland::gradient_bound() const {
  if (smoothness_ == 0) return l_;
  constexpr int steps = 60;  // beyond the 53 bits of a double
  // phi'' changes sign once in (0, 1): bisection.
  double lo = 0;
  double hi = 1;
  for (int step = 0; step < steps; ++step) {
    const double mid = 0.5 * (lo + hi);
    (second(mid) < 0 ? lo : hi) = mid;
  }
  return -hi * g(hi);
}

double Wendland::hessian_bound() const {
  return smoothness_ == 0 ? std::numeric_limits<double>::infinity() : -g_[0];
}

void Wendland::values(const double* r2, Index n, double* phi) const {
  if (run(value_loop, l_, smoothness_, {value_, g_, h_}, r2, n, {phi, nullptr, nullptr})) return;
  for (Index i = 0; i < n; ++i) phi[i] = value(std::sqrt(r2[i]));
}

void Wendland::gradients(const double* r2, Index n, double* phi, double* g) const {
  if (run(gradient_loop, l_, smoothness_, {value_, g_, h_}, r2, n, {phi, g, nullptr})) return;
  for (Index i = 0; i < n; ++i) {
    const double r = std::sqrt(r2[i]);
    phi[i] = value(r);
    g[i] = this->g(r);
  }
}

void Wendland::hessians(const double* r2, Index n, double* phi, double* g, double* h) const {
  if (run(hessian_loop, l_, smoothness_, {value_, g_, h_}, r2, n, {phi, g, h})) return;
  for (Index i = 0; i < n; ++i) {
    const double r = std::sqrt(r2[i]);
    phi[i] = value(r);
    g[i] = this->g(r);
    h[i] = this->h(r);
  }
}

}  // namespace csrbf
