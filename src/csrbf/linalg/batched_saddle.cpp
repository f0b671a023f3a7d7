#include "csrbf/linalg/batched_saddle.hpp"

#include "csrbf/core/lanes.hpp"

#include <vector>

namespace csrbf {
namespace {

constexpr int lanes = batch_lanes;

constexpr double dependent = 1e-11;       // as in solve_saddle(): share of a column of G outside the span of the others
constexpr double smallest_pivot = 1e-15;  // relative to the diagonal: a few roundings

// I - beta v v^T on components first, ..., n - 1.
struct Reflector {
  const double* v;
  Index first;
  double beta[lanes];
};

template <class V>
CSRBF_ALWAYS_INLINE void reflect(const Reflector& H, Index n, double* x) {
  V sum(0.0);
  for (Index i = lanes * H.first; i < lanes * n; i += lanes) sum += V(H.v + i) * V(x + i);
  sum *= V(H.beta);
  for (Index i = lanes * H.first; i < lanes * n; i += lanes) (V(x + i) - sum * V(H.v + i)).store(x + i);
}

// Replaces column g of G by the vector of the reflector that reduces its components q, ..., n - 1 to the first one,
// which becomes `remainder`.
template <class V>
CSRBF_ALWAYS_INLINE Reflector make_reflector(double* g, Index q, Index n, double* remainder) {
  Reflector H{g, q, {}};
  V sum(0.0);
  for (Index i = lanes * q; i < lanes * n; i += lanes) sum += V(g + i) * V(g + i);
  for (int l = 0; l < lanes; ++l) {
    const double norm = std::sqrt(sum[l]);
    const double head = g[lanes * q + l];
    remainder[l] = head > 0 ? -norm : norm;
    g[lanes * q + l] = head - remainder[l];
    const double length = norm * (norm + std::abs(head));
    H.beta[l] = length > 0 ? 1 / length : 0;
  }
  return H;
}

// w = beta A v - (beta^2 v^T A v / 2) v on the trailing block: H A H = A - v w^T - w v^T.
template <class V>
CSRBF_ALWAYS_INLINE void two_sided_vector(const Reflector& H, const double* A, Index n, double* w) {
  std::fill(w + lanes * H.first, w + lanes * n, 0.0);
  for (Index i = H.first; i < n; ++i) {
    const double* row = A + batch_entry(i, 0);
    const V vi(H.v + lanes * i);
    V sum = V(row + lanes * i) * vi;
    for (Index j = lanes * H.first; j < lanes * i; j += lanes) {
      const V a(row + j);
      sum += a * V(H.v + j);
      (V(w + j) + a * vi).store(w + j);
    }
    (V(w + lanes * i) + sum).store(w + lanes * i);
  }
  const V beta(H.beta);
  V product(0.0);
  for (Index i = lanes * H.first; i < lanes * n; i += lanes) product += V(w + i) * V(H.v + i);
  for (Index i = lanes * H.first; i < lanes * n; i += lanes)
    (beta * (V(w + i) - 0.5 * beta * product * V(H.v + i))).store(w + i);
}

// A = H A H: columns before H.first from the left, the trailing block from both sides.
template <class V>
CSRBF_ALWAYS_INLINE void reflect_matrix(const Reflector& H, Index n, double* A, double* w, double* column) {
  for (Index c = 0; c < H.first; ++c) {
    for (Index i = H.first; i < n; ++i) std::copy_n(A + batch_entry(i, c), lanes, column + lanes * i);
    reflect<V>(H, n, column);
    for (Index i = H.first; i < n; ++i) std::copy_n(column + lanes * i, lanes, A + batch_entry(i, c));
  }
  two_sided_vector<V>(H, A, n, w);
  for (Index i = H.first; i < n; ++i) {
    double* row = A + batch_entry(i, 0);
    const V vi(H.v + lanes * i), wi(w + lanes * i);
    for (Index j = lanes * H.first; j <= lanes * i; j += lanes) {
      const V vw = vi * V(w + j), wv = wi * V(H.v + j);
      (V(row + j) - (vw + wv)).store(row + j);
    }
  }
}

// The QR decomposition of G, applied to A from both sides and to s. `R` gets the diagonal of R; the rest of it is above
// the diagonal of G, the vectors of the reflectors from there on. Sets `deficient` to 1 for rank-deficient lanes.
struct Reduce {
  template <int Bytes>
  CSRBF_ALWAYS_INLINE static void run(const BatchSaddle* system, Reflector* H, double* R, double* deficient) {
    using V = Lanes<double, lanes, Bytes>;
    const BatchSaddle m = *system;
    for (Index q = 0; q < m.Q; ++q) {
      double* g = m.G + lanes * q * m.n;
      V squares(0.0);
      for (Index i = 0; i < lanes * m.n; i += lanes) squares += V(g + i) * V(g + i);
      H[q] = make_reflector<V>(g, q, m.n, R + lanes * q);
      for (int l = 0; l < lanes; ++l)
        if (!(std::abs(R[lanes * q + l]) > dependent * std::sqrt(squares[l]))) deficient[l] = 1;
      for (Index p = q + 1; p < m.Q; ++p) reflect<V>(H[q], m.n, m.G + lanes * p * m.n);
      for (Index c = 0; c < m.count; ++c) reflect<V>(H[q], m.n, m.s + lanes * c * m.n);
      reflect_matrix<V>(H[q], m.n, m.A, m.work, m.work + lanes * m.n);
    }
  }
};

// pi from R pi = s_Q - A_Qz y, where the first Q components of the rotated s are s_Q, and alpha = H_1 ... H_Q [0; y].
// Left to the vectoriser, which rounds some products by themselves: Lanes would change the last bits.
CSRBF_ALWAYS_INLINE void expand(const BatchSaddle& m, const Reflector* H, const double* R) {
  for (Index c = 0; c < m.count; ++c) {
    double* s = m.s + lanes * c * m.n;
    double* pi = m.pi + lanes * c * m.Q;
    for (Index q = m.Q - 1; q >= 0; --q) {
      double sum[lanes];
      std::copy_n(s + lanes * q, lanes, sum);
      for (Index i = m.Q; i < m.n; ++i) {
        const double* a = m.A + batch_entry(i, q);
        for (int l = 0; l < lanes; ++l) sum[l] -= a[l] * s[lanes * i + l];
      }
      for (Index p = q + 1; p < m.Q; ++p) {
        const double* r = m.G + lanes * (p * m.n + q);
        for (int l = 0; l < lanes; ++l) sum[l] -= r[l] * pi[lanes * p + l];
      }
      for (int l = 0; l < lanes; ++l) pi[lanes * q + l] = sum[l] / R[lanes * q + l];
    }
    std::fill_n(s, lanes * m.Q, 0.0);
    for (Index q = m.Q - 1; q >= 0; --q) reflect<Doubles>(H[q], m.n, s);
  }
}

}  // namespace

BatchMask batch_saddle(const BatchSaddle& m) {
  std::vector<Reflector> H(m.Q);
  std::vector<double> R(lanes * m.Q);
  double deficient[lanes] = {};
  simd_call<Reduce>(&m, H.data(), R.data(), deficient);
  const Index z = m.n - m.Q;
  double* const null_space = m.work + 2 * lanes * m.n;
  for (Index i = 0; i < z; ++i)
    std::copy_n(m.A + batch_entry(m.Q + i, m.Q), lanes * (i + 1), null_space + batch_entry(i, 0));
  BatchMask failed = batch_cholesky(null_space, z, smallest_pivot);
  for (Index c = 0; c < m.count; ++c) batch_solve(null_space, z, m.s + lanes * (c * m.n + m.Q));
  simd<expand>(m, H.data(), R.data());
  for (int l = 0; l < lanes; ++l)
    if (deficient[l] > 0) failed |= BatchMask{1} << l;
  return failed;
}

}  // namespace csrbf
