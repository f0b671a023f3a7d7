#include "csrbf/approx/unity/lane_sums.hpp"

#include "csrbf/core/lanes.hpp"

#include <array>
#include <bit>
#include <cmath>

namespace csrbf::lane_sums {
namespace {

// Gradient and Hessian of x[axis] times a function by the product rule.
CSRBF_ALWAYS_INLINE void derive(const double* x, int dim, int axis, int terms, const double* from, double* to) {
  const Doubles factor(x + lanes * axis);
  const auto at = [](int term) { return lanes * term; };
  for (int a = 0; a < dim; ++a) {
    Doubles g = Doubles(from + at(1 + a)) * factor;
    if (a == axis) g += Doubles(from);
    g.store(to + at(1 + a));
  }
  for (int a = 0, t = 1 + dim; a < dim && t < terms; ++a)
    for (int b = a; b < dim; ++b, ++t) {
      Doubles h = Doubles(from + at(t)) * factor;
      if (a == axis) h += Doubles(from + at(1 + b));
      if (b == axis) h += Doubles(from + at(1 + a));
      h.store(to + at(t));
    }
}

CSRBF_ALWAYS_INLINE void distances_in(int dim, const double* x, const double* centers, Index n, double scale,
                                      double* r2) {
  for (Index j = 0; j < n; ++j) {
    Doubles sum(0.0);
    for (int a = 0; a < dim; ++a) {
      const Doubles d = Doubles(x + lanes * a) - centers[dim * j + a];
      sum += d * d;
    }
    (sum * scale).store(r2 + lanes * j);
  }
}

// The polynomial of a degree in the first A + 1 variables whose coefficients come next.
template <int A>
CSRBF_ALWAYS_INLINE void horner(const double* x, int degree, const double*& c, Doubles& p) {
  const Doubles variable(x + lanes * A);
  if constexpr (A == 0) {
    p = Doubles(*c++);
    for (int d = 0; d < degree; ++d) p = p * variable + *c++;
  } else {
    horner<A - 1>(x, 0, c, p);
    for (int d = 1; d <= degree; ++d) {
      Doubles row;
      horner<A - 1>(x, d, c, row);
      p = row + p * variable;
    }
  }
}

// For every set of lanes, as bits, the lanes in it and anything behind them.
constexpr auto lanes_of = [] {
  std::array<std::array<std::uint8_t, lanes>, 1 << lanes> table{};
  for (unsigned set = 0; set < table.size(); ++set)
    for (std::size_t lane = 0, count = 0; lane < lanes; ++lane)
      if ((set >> lane & 1U) != 0) table[set][count++] = static_cast<std::uint8_t>(lane);
  return table;
}();

template <int Dim>
CSRBF_ALWAYS_INLINE std::size_t inside_in(const double* x, std::size_t stride, std::uint32_t begin, std::uint32_t end,
                                          const double* center, const double* half, std::uint32_t* found) {
  std::size_t count = 0;
  for (std::uint32_t i = begin; i < end; i += lanes) {
    Doubles::Mask inside(-1);
    for (std::size_t a = 0; a < Dim; ++a) {
      const Doubles d = Doubles(x + stride * a + i) - center[a];
      inside &= (d < half[a]) & (d > -half[a]);
    }
    const std::uint32_t left = end - i;
    const unsigned set = bits(inside) & (left < lanes ? (1U << left) - 1 : ~0U);
    for (std::size_t l = 0; l < lanes; ++l) found[count + l] = i + lanes_of[set][l];
    count += static_cast<std::size_t>(std::popcount(set));
  }
  return count;
}

// The product of the factors b = s^4, b' = -8 t s^3 / half or b'' = 8 s^2 (7 t^2 - 1) / half^2 of the axes, s = 1 -
// t^2, those of `first` and `second` derived.
CSRBF_ALWAYS_INLINE void weight_derivative(const double* t, const double* s, int dim, const double* half, int first,
                                           int second, double* w) {
  Doubles product(1.0);
  for (int a = 0; a < dim; ++a, t += lanes, s += lanes) {
    const double inverse = 1 / half[a];
    const int derived = (a == first ? 1 : 0) + (a == second ? 1 : 0);
    const Doubles place(t), slope(s);
    Doubles factor = slope * slope;
    if (derived == 0)
      factor *= factor;
    else if (derived == 1)
      factor = factor * slope * place * (-8 * inverse);
    else
      factor = factor * (place * place * 7.0 - 1.0) * (8 * inverse * inverse);
    product *= factor;
  }
  product.store(w);
}

namespace loops {

CSRBF_ALWAYS_INLINE void nested_polynomial(const double* x, int dim, int degree, const double* c, double* f) {
  Doubles p;
  switch (dim) {
    case 1:
      horner<0>(x, degree, c, p);
      break;
    case 2:
      horner<1>(x, degree, c, p);
      break;
    case 3:
      horner<2>(x, degree, c, p);
      break;
    case 4:
      horner<3>(x, degree, c, p);
      break;
    case 5:
      horner<4>(x, degree, c, p);
      break;
    default:
      horner<5>(x, degree, c, p);
  }
  p.store(f);
}

CSRBF_ALWAYS_INLINE std::size_t inside(const double* x, std::size_t stride, int dim, std::uint32_t begin,
                                       std::uint32_t end, const double* center, const double* half,
                                       std::uint32_t* found) {
  switch (dim) {
    case 1:
      return inside_in<1>(x, stride, begin, end, center, half, found);
    case 2:
      return inside_in<2>(x, stride, begin, end, center, half, found);
    case 3:
      return inside_in<3>(x, stride, begin, end, center, half, found);
    case 4:
      return inside_in<4>(x, stride, begin, end, center, half, found);
    case 5:
      return inside_in<5>(x, stride, begin, end, center, half, found);
    default:
      return inside_in<6>(x, stride, begin, end, center, half, found);
  }
}

CSRBF_ALWAYS_INLINE void polynomial(const double* x, int dim, const std::int16_t* parent, const std::int16_t* axis,
                                    Index n, const double* c, int terms, double* jets, double* f) {
  for (int i = 0; i < lanes * terms; ++i) f[i] = 0;
  if (n == 0) return;
  for (int i = 0; i < lanes * terms; ++i) jets[i] = i < lanes ? 1 : 0;
  Doubles sum(c[0]);
  for (Index j = 1; j < n; ++j) {
    const double* from = jets + lanes * terms * parent[j];
    double* to = jets + lanes * terms * j;
    const Doubles product = Doubles(from) * Doubles(x + lanes * axis[j]);
    product.store(to);
    sum += c[j] * product;
    if (terms == 1) continue;
    derive(x, dim, axis[j], terms, from, to);
    for (int i = lanes; i < lanes * terms; i += lanes) (Doubles(f + i) + c[j] * Doubles(to + i)).store(f + i);
  }
  sum.store(f);
}

CSRBF_ALWAYS_INLINE void add_row(const double* q, const double* weight, Index n, const double* c, int degree, double w,
                                 double* W, double* S) {
  for (Index i = 0; i < n; i += lanes) {
    const Doubles x(q + i);
    Doubles p(degree < 0 ? 0 : c[degree]);
    for (int d = degree - 1; d >= 0; --d) p = p * x + c[d];
    const Doubles share = Doubles(weight + i) * w;
    (Doubles(W + i) + share).store(W + i);
    (Doubles(S + i) + share * p).store(S + i);
  }
}

CSRBF_ALWAYS_INLINE void distances(const double* x, int dim, const double* centers, Index n, double scale, double* r2) {
  switch (dim) {  // loops of known length are unrolled
    case 1:
      return distances_in(1, x, centers, n, scale, r2);
    case 2:
      return distances_in(2, x, centers, n, scale, r2);
    case 3:
      return distances_in(3, x, centers, n, scale, r2);
    default:
      return distances_in(dim, x, centers, n, scale, r2);
  }
}

CSRBF_ALWAYS_INLINE void add_values(const double* phi, const double* alpha, Index n, double* f) {
  Doubles sum(f);
  for (Index j = 0; j < n; ++j) sum += alpha[j] * Doubles(phi + lanes * j);
  sum.store(f);
}

CSRBF_ALWAYS_INLINE void add_gradients(const double* g, const double* alpha, Index n, const double* x, int dim,
                                       const double* centers, double scale, double* f) {
  for (int a = 0; a < dim; ++a) {
    const Doubles coordinate(x + lanes * a);
    Doubles sum(f + lanes * (1 + a));
    for (Index j = 0; j < n; ++j)
      sum += (scale * alpha[j]) * ((coordinate - centers[dim * j + a]) * Doubles(g + lanes * j));
    sum.store(f + lanes * (1 + a));
  }
}

CSRBF_ALWAYS_INLINE void add_hessians(const double* g, const double* h, const double* alpha, Index n, const double* x,
                                      int dim, const double* centers, double scale, double* f) {
  double* entry = f + lanes * (1 + dim);
  for (int a = 0; a < dim; ++a)
    for (int b = a; b < dim; ++b, entry += lanes) {
      const Doubles xa(x + lanes * a), xb(x + lanes * b);
      Doubles sum(entry);
      for (Index j = 0; j < n; ++j) {
        const Doubles da = xa - centers[dim * j + a], db = xb - centers[dim * j + b];
        Doubles outer = Doubles(h + lanes * j) * da * db * scale;
        if (a == b) outer += Doubles(g + lanes * j);
        sum += (scale * alpha[j]) * outer;
      }
      sum.store(entry);
    }
}

CSRBF_ALWAYS_INLINE void box_weights(const double* x, int dim, const double* center, const double* half, int terms,
                                     double* w) {
  constexpr int most = 8;
  double t[most * lanes], s[most * lanes];
  Doubles weight(1.0);
  for (int a = 0; a < dim; ++a) {
    const Doubles place = (Doubles(x + lanes * a) - center[a]) * (1 / half[a]);
    const Doubles parabola = 1.0 - place * place, none(0.0);
    const Doubles factor = choose(parabola > none, parabola, none);
    weight *= factor;
    place.store(t + lanes * a);
    factor.store(s + lanes * a);
  }
  weight *= weight;
  weight *= weight;
  weight.store(w);
  if (terms == 1) return;
  for (int a = 0; a < dim; ++a) weight_derivative(t, s, dim, half, a, -1, w + lanes * (1 + a));
  for (int a = 0, term = 1 + dim; a < dim && term < terms; ++a)
    for (int b = a; b < dim; ++b, ++term) weight_derivative(t, s, dim, half, a, b, w + lanes * term);
}

}  // namespace loops
}  // namespace

void nested_polynomial(const double* x, int dim, int degree, const double* c, double* f) {
  simd<loops::nested_polynomial>(x, dim, degree, c, f);
}

std::size_t inside(const double* x, std::size_t stride, int dim, std::uint32_t begin, std::uint32_t end,
                   const double* center, const double* half, std::uint32_t* found) {
  return simd<loops::inside>(x, stride, dim, begin, end, center, half, found);
}

void polynomial(const double* x, int dim, const std::int16_t* parent, const std::int16_t* axis, Index n,
                const double* c, int terms, double* jets, double* f) {
  simd<loops::polynomial>(x, dim, parent, axis, n, c, terms, jets, f);
}

void add_row(const double* q, const double* weight, Index n, const double* c, int degree, double w, double* W,
             double* S) {
  simd<loops::add_row>(q, weight, n, c, degree, w, W, S);
}

void distances(const double* x, int dim, const double* centers, Index n, double scale, double* r2) {
  simd<loops::distances>(x, dim, centers, n, scale, r2);
}

void add_values(const double* phi, const double* alpha, Index n, double* f) {
  simd<loops::add_values>(phi, alpha, n, f);
}

void add_gradients(const double* g, const double* alpha, Index n, const double* x, int dim, const double* centers,
                   double scale, double* f) {
  simd<loops::add_gradients>(g, alpha, n, x, dim, centers, scale, f);
}

void add_hessians(const double* g, const double* h, const double* alpha, Index n, const double* x, int dim,
                  const double* centers, double scale, double* f) {
  simd<loops::add_hessians>(g, h, alpha, n, x, dim, centers, scale, f);
}

void box_weights(const double* x, int dim, const double* center, const double* half, int terms, double* w) {
  simd<loops::box_weights>(x, dim, center, half, terms, w);
}

}  // namespace csrbf::lane_sums
