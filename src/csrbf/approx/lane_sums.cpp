#include "csrbf/approx/lane_sums.hpp"

#include "csrbf/core/simd.hpp"

namespace csrbf::lane_sums {
namespace {

// Gradient and Hessian of x[axis] times a function by the product rule.
CSRBF_ALWAYS_INLINE void derive(const double* x, int dim, int axis, int terms, const double* from, double* to) {
  for (int a = 0; a < dim; ++a)
    for (int l = 0; l < lanes; ++l) to[lanes * (1 + a) + l] = x[lanes * axis + l] * from[lanes * (1 + a) + l];
  for (int l = 0; l < lanes; ++l) to[lanes * (1 + axis) + l] += from[l];
  for (int a = 0, t = 1 + dim; a < dim && t < terms; ++a)
    for (int b = a; b < dim; ++b, ++t) {
      for (int l = 0; l < lanes; ++l) to[lanes * t + l] = x[lanes * axis + l] * from[lanes * t + l];
      if (a == axis)
        for (int l = 0; l < lanes; ++l) to[lanes * t + l] += from[lanes * (1 + b) + l];
      if (b == axis)
        for (int l = 0; l < lanes; ++l) to[lanes * t + l] += from[lanes * (1 + a) + l];
    }
}

}  // namespace

CSRBF_SIMD_CLONES void polynomial(const double* x, int dim, const std::int16_t* parent, const std::int16_t* axis,
                                  Index n, const double* c, int terms, double* jets, double* f) {
  for (int i = 0; i < lanes * terms; ++i) f[i] = 0;
  if (n == 0) return;
  for (int i = 0; i < lanes * terms; ++i) jets[i] = i < lanes ? 1 : 0;
  double sum[lanes];
  for (int l = 0; l < lanes; ++l) sum[l] = c[0];
  for (Index j = 1; j < n; ++j) {
    const double* from = jets + lanes * terms * parent[j];
    double* to = jets + lanes * terms * j;
    double product[lanes];
    for (int l = 0; l < lanes; ++l) product[l] = x[lanes * axis[j] + l] * from[l];
    for (int l = 0; l < lanes; ++l) sum[l] += c[j] * product[l];
    for (int l = 0; l < lanes; ++l) to[l] = product[l];
    if (terms == 1) continue;
    derive(x, dim, axis[j], terms, from, to);
    for (int i = lanes; i < lanes * terms; ++i) f[i] += c[j] * to[i];
  }
  for (int l = 0; l < lanes; ++l) f[l] = sum[l];
}

CSRBF_SIMD_CLONES void add_row(const double* q, const double* weight, Index n, const double* c, int degree, double w,
                               double* W, double* S) {
  for (Index i = 0; i < n; i += lanes) {
    double p[lanes], x[lanes], share[lanes];
    for (int l = 0; l < lanes; ++l) {
      p[l] = degree < 0 ? 0 : c[degree];
      x[l] = q[i + l];
    }
    for (int d = degree - 1; d >= 0; --d)
      for (int l = 0; l < lanes; ++l) p[l] = p[l] * x[l] + c[d];
    for (int l = 0; l < lanes; ++l) share[l] = w * weight[i + l];
    for (int l = 0; l < lanes; ++l) W[i + l] += share[l];
    for (int l = 0; l < lanes; ++l) S[i + l] += share[l] * p[l];
  }
}

CSRBF_SIMD_CLONES void distances(const double* x, int dim, const double* centers, Index n, double scale, double* r2) {
  for (Index j = 0; j < n; ++j) {
    double sum[lanes] = {};
    for (int a = 0; a < dim; ++a) {
      const double c = centers[dim * j + a];
      for (int l = 0; l < lanes; ++l) {
        const double d = x[lanes * a + l] - c;
        sum[l] += d * d;
      }
    }
    for (int l = 0; l < lanes; ++l) r2[lanes * j + l] = scale * sum[l];
  }
}

CSRBF_SIMD_CLONES void add_values(const double* phi, const double* alpha, Index n, double* f) {
  double sum[lanes] = {};
  for (Index j = 0; j < n; ++j)
    for (int l = 0; l < lanes; ++l) sum[l] += alpha[j] * phi[lanes * j + l];
  for (int l = 0; l < lanes; ++l) f[l] += sum[l];
}

CSRBF_SIMD_CLONES void add_gradients(const double* g, const double* alpha, Index n, const double* x, int dim,
                                     const double* centers, double scale, double* f) {
  for (int a = 0; a < dim; ++a) {
    double sum[lanes] = {};
    for (Index j = 0; j < n; ++j) {
      const double c = centers[dim * j + a], weight = scale * alpha[j];
      for (int l = 0; l < lanes; ++l) sum[l] += weight * g[lanes * j + l] * (x[lanes * a + l] - c);
    }
    for (int l = 0; l < lanes; ++l) f[lanes * (1 + a) + l] += sum[l];
  }
}

CSRBF_SIMD_CLONES void add_hessians(const double* g, const double* h, const double* alpha, Index n, const double* x,
                                    int dim, const double* centers, double scale, double* f) {
  double* entry = f + lanes * (1 + dim);
  for (int a = 0; a < dim; ++a)
    for (int b = a; b < dim; ++b, entry += lanes) {
      double sum[lanes] = {};
      for (Index j = 0; j < n; ++j) {
        const double ca = centers[dim * j + a], cb = centers[dim * j + b], weight = scale * alpha[j];
        for (int l = 0; l < lanes; ++l) {
          const double outer = scale * h[lanes * j + l] * (x[lanes * a + l] - ca) * (x[lanes * b + l] - cb);
          sum[l] += weight * (a == b ? g[lanes * j + l] + outer : outer);
        }
      }
      for (int l = 0; l < lanes; ++l) entry[l] += sum[l];
    }
}

CSRBF_SIMD_CLONES bool box_weights(const double* x, int dim, const double* center, const double* half, int terms,
                                   double* w) {
  constexpr int most = 8;
  double t[most][lanes], s[most][lanes], inside[lanes];
  for (int l = 0; l < lanes; ++l) inside[l] = 1;
  for (int a = 0; a < dim; ++a) {
    const double inverse = 1 / half[a], c = center[a];
    for (int l = 0; l < lanes; ++l) {
      t[a][l] = (x[lanes * a + l] - c) * inverse;
      const double square = 1 - t[a][l] * t[a][l];
      s[a][l] = square > 0 ? square : 0;
      inside[l] *= s[a][l];
    }
  }
  double any = 0;
  for (int l = 0; l < lanes; ++l) any += inside[l];
  if (!(any > 0)) return false;
  for (int l = 0; l < lanes; ++l) {
    const double square = inside[l] * inside[l];
    w[l] = square * square;
  }
  if (terms == 1) return true;
  // Factors b = s^4, b' = -8 t s^3 / half and b'' = 8 s^2 (7 t^2 - 1) / half^2 of the axes, `first` and `second`
  // derived.
  const auto product = [&](int first, int second, double* out) {
    for (int l = 0; l < lanes; ++l) out[l] = 1;
    for (int a = 0; a < dim; ++a) {
      const double inverse = 1 / half[a];
      const int derived = (a == first ? 1 : 0) + (a == second ? 1 : 0);
      for (int l = 0; l < lanes; ++l) {
        const double u = t[a][l], v = s[a][l], v2 = v * v;
        const double factor = derived == 0   ? v2 * v2
                              : derived == 1 ? -8 * u * v2 * v * inverse
                                             : 8 * v2 * (7 * u * u - 1) * inverse * inverse;
        out[l] *= factor;
      }
    }
  };
  for (int a = 0; a < dim; ++a) product(a, -1, w + lanes * (1 + a));
  for (int a = 0, term = 1 + dim; a < dim && term < terms; ++a)
    for (int b = a; b < dim; ++b, ++term) product(a, b, w + lanes * term);
  return true;
}

}  // namespace csrbf::lane_sums
